"use strict";
// Elements and charts. Every text enters the page as a text node or an attribute, never as markup.

function h(tag, attributes, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes || {})) {
        if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
        else if (value !== null && value !== undefined && value !== false)
            element.setAttribute(name, value === true ? "" : value);
    }
    element.append(...children.flat().filter((child) => child !== null && child !== undefined));
    return element;
}

const tableOf = (attributes, headings, lines) =>
    h("table", attributes, h("thead", {}, h("tr", {}, headings)), h("tbody", {}, lines));
const heading = (words, kind = "") => h("th", {scope: "col", class: kind}, words);
const numberHeading = (words, unit) => heading([words, h("small", {}, ` ${unit}`)].flat(), "n");
// What may be wider than the page scrolls on its own.
const region = (label, ...content) =>
    h("div", {class: "wide", tabindex: "0", role: "region", "aria-label": label}, content);

// May be broken behind its slashes and before its options.
function caseName(id) {
    return h(
        "code",
        {},
        id.split(/(?<=\/)|(?=\+)/).flatMap((part, i) => (i ? [document.createElement("wbr"), part] : [part])),
    );
}

// Class names that page.css gives a colour.
const kVariantColours = 8;
function variantColour(variant) {
    const place = valuesOf("variant").indexOf(variant);
    return `v-${place >= 0 && place < kVariantColours ? place : "other"}`;
}
const kBuffers = ["vertex", "index", "meshlet", "additional_meshlet", "tuple", "palette", "skinned"];
const kPasses = ["skin", "upload", "bounds", "cluster", "cull", "views", "depth", "draw"];
const kShapes = {
    circle: "M-5,0a5,5 0 1,0 10,0a5,5 0 1,0 -10,0Z",
    square: "M-4.5,-4.5H4.5V4.5H-4.5Z",
    diamond: "M0,-6L6,0L0,6L-6,0Z",
    up: "M0,-6L5.6,4.5H-5.6Z",
    down: "M0,6L5.6,-4.5H-5.6Z",
    cross: "M-2,-6H2V-2H6V2H2V6H-2V2H-6V-2H-2Z",
    bar: "M-2,-6H2V6H-2Z",
};
const routeShape = (route) => Object.values(kShapes)[Math.max(0, valuesOf("route").indexOf(route)) % 7];

let chartNumber = 0;

// Draws when the element has a width, and whenever that changes. All charts are told at once, so the page is laid out
// once and not for each of them.
function drawn(host, draw) {
    let width = 0;
    new ResizeObserver((entries) => {
        const now = Math.floor(entries[entries.length - 1].contentRect.width);
        if (now < 40 || now === width) return;
        width = now;
        draw(width);
    }).observe(host);
}

function legend(entries) {
    if (entries.length < 2) return null;
    return h(
        "ul",
        {class: "legend"},
        entries.map(({name, colour, shape}) => {
            if (!shape) return h("li", {}, h("span", {class: `swatch ${colour}`}), name);
            const icon = d3.create("svg").attr("viewBox", "-7 -7 14 14").attr("aria-hidden", "true");
            icon.append("path").attr("d", shape);
            return h("li", {}, icon.node(), name);
        }),
    );
}

// A figure with its title, what it says, and the same figures as a table.
function figure({title, note, legendEntries = [], table}) {
    const id = `chart-${++chartNumber}`;
    const host = h("div", {class: "chart"});
    const node = h(
        "figure",
        {},
        h("figcaption", {id}, h("strong", {}, title), note ? h("span", {}, note) : null),
        legend(legendEntries),
        host,
    );
    if (table) {
        const details = h("details", {class: "as-table"}, h("summary", {}, "The same as a table"));
        details.addEventListener("toggle", () => {
            if (details.open && details.children.length === 1) details.append(plainTable(table()));
        });
        node.append(details);
    }
    return {node, host, id};
}

function plainTable({head, rows}) {
    const isNumber = (value) => /^[-–\d.,e*×<>]*$/.test(value);
    const kinds = head.map((_, i) => (i > 0 && rows.every((row) => isNumber(row[i])) ? "n" : ""));
    const cell = (value, column) => h("td", {class: kinds[column]}, value);
    return region(
        "Table",
        tableOf(
            {},
            head.map((name, i) => heading(name, kinds[i])),
            rows.map((row) => h("tr", {}, row.map(cell))),
        ),
    );
}

function axisScale(chart, rows, range) {
    const ends = rows.flatMap((row) =>
        [row.end, ...(row.whisker || []), ...(row.dots || []).map((dot) => dot.x), row.tick].filter(
            (value) => number(value) !== null,
        ),
    );
    if (!chart.ratio)
        return d3
            .scaleLinear()
            .domain([0, Math.max(...ends) || 1])
            .range(range);
    const far = Math.max(1.02, ...ends.filter((end) => end > 0).map((end) => Math.max(end, 1 / end)));
    const low = Math.min(1, ...ends.filter((end) => end > 0)),
        high = Math.max(1, ...ends);
    const room = Math.pow(far, 0.06);
    return d3
        .scaleLog()
        .domain([low / room, high * room])
        .range(range);
}

// Values between which a logarithmic axis of ratios near 1 has room for its labels.
function ratioTicks(scale, width) {
    const [low, high] = scale.domain();
    return d3
        .scaleLinear()
        .domain([low, high])
        .ticks(Math.max(2, Math.floor(width / 90)));
}

function drawAxis(svg, chart, scale, y, height) {
    const [left, right] = scale.range();
    const ticks = chart.ratio
        ? ratioTicks(scale, right - left)
        : scale.ticks(Math.max(2, Math.floor((right - left) / 90)));
    const axis = d3.axisTop(scale).tickValues(ticks).tickSizeInner(-height).tickSizeOuter(0).tickPadding(6);
    axis.tickFormat(
        chart.ratio ? (value) => value.toFixed(high(scale) > 4 ? 1 : 2) : (value) => grouped(+value.toFixed(6)),
    );
    svg.append("g").attr("class", "axis").attr("transform", `translate(0,${y})`).call(axis);
    if (chart.ratio)
        svg.append("line")
            .attr("class", "one")
            .attr("x1", scale(1))
            .attr("x2", scale(1))
            .attr("y1", y)
            .attr("y2", y + height);
}
const high = (scale) => scale.domain()[1];

function drawMarks(group, row, scale, y, size) {
    const middle = y + size / 2;
    let from = 0;
    for (const segment of row.segments || []) {
        group
            .append("rect")
            .attr("class", `${segment.colour}${row.software ? " software" : ""}`)
            .attr("x", scale(from))
            .attr("y", y)
            .attr("height", size)
            .attr("width", Math.max(0.5, scale(from + segment.value) - scale(from)));
        from += segment.value;
    }
    for (const dot of row.dots || [])
        group
            .append("circle")
            .attr("class", `dot ${dot.colour || ""}`)
            .attr("cx", scale(dot.x))
            .attr("cy", middle)
            .attr("r", 4)
            .append("title")
            .text(dot.title);
    if (row.whisker) {
        const [a, b] = row.whisker.map(scale),
            cap = size * 0.3;
        group
            .append("path")
            .attr("class", "whisker")
            .attr(
                "d",
                `M${a},${middle}H${b}M${a},${middle - cap}V${middle + cap}M${b},${middle - cap}V${middle + cap}`,
            );
    }
    if (row.tick)
        group
            .append("path")
            .attr("class", "limit")
            .attr("d", `M${scale(row.tick)},${y - 3}V${y + size + 3}`);
    if (row.median)
        group
            .append("path")
            .attr("class", "median")
            .attr("d", `M${scale(row.median)},${middle - 8}V${middle + 8}`);
}

function drawRows(host, chart, rows, id, width) {
    const values = Math.max(...rows.map((row) => row.value.length)) * 7 + 10;
    const longest = Math.max(...rows.map((row) => row.label.length)) * 7.0 + 16;
    const beside = longest < width * 0.5 && width > 520;
    const left = beside ? Math.max(longest, 60) : 2,
        right = width - values - 4;
    const size = 14,
        step = beside ? 24 : 42,
        headStep = 34,
        top = 24;
    let height = top;
    for (const row of rows) height += row.heading ? headStep : step;
    const scale = axisScale(
        chart,
        rows.filter((row) => !row.heading),
        [left, right],
    );
    const svg = d3
        .create("svg")
        .attr("viewBox", `0 0 ${width} ${height + 4}`)
        .attr("role", "img")
        .attr("aria-labelledby", id);
    drawAxis(svg, chart, scale, top, height - top);
    let y = top;
    for (const row of rows) {
        if (row.heading) {
            svg.append("text")
                .attr("class", "heading")
                .attr("x", 0)
                .attr("y", y + 24)
                .text(row.label);
            y += headStep;
            continue;
        }
        const barY = beside ? y + 5 : y + 22;
        const group = svg.append("g").attr("class", "row");
        group.append("title").text(row.title || `${row.label}: ${row.value}`);
        group
            .append("text")
            .attr("class", "label")
            .attr("x", beside ? left - 8 : 2)
            .attr("y", beside ? barY + 11 : y + 16)
            .attr("text-anchor", beside ? "end" : "start")
            .text(row.label);
        drawMarks(group, row, scale, barY, size);
        group
            .append("text")
            .attr("class", "value")
            .attr("x", width)
            .attr("y", barY + 11)
            .attr("text-anchor", "end")
            .text(row.value);
        y += beside ? 24 : 42;
    }
    host.replaceChildren(svg.node());
}

// Horizontal rows: {label, value, end, segments, whisker, tick, dots, median, software, title}, or {heading, label}.
// Shows `most` rows under each heading until all are asked for. `table` is {head, row(row)}.
function rowChart({title, note, rows, ratio = false, legendEntries, most = Infinity, table}) {
    const parts = figure({
        title,
        note,
        legendEntries,
        table: () => ({head: table.head, rows: rows.filter((row) => !row.heading).map(table.row)}),
    });
    let count = 0;
    const few = rows.filter((row) => (row.heading ? ((count = 0), true) : ++count <= most));
    let shown = few;
    const draw = (width) => drawRows(parts.host, {ratio}, shown, parts.id, width);
    drawn(parts.host, draw);
    if (few.length < rows.length) {
        const button = h("button", {
            type: "button",
            class: "more",
            "aria-expanded": "false",
            onclick: () => {
                shown = shown === few ? rows : few;
                button.setAttribute("aria-expanded", String(shown === rows));
                button.textContent = label();
                draw(Math.floor(parts.host.clientWidth));
            },
        });
        const label = () =>
            shown === few ? `Show all ${rows.filter((row) => !row.heading).length} rows` : "Show fewer rows";
        button.textContent = label();
        parts.host.after(button);
    }
    return parts.node;
}

// points: {x, y, interval, colour, shape, label, software}
function scatterChart({title, note, points, xLabel, yLabel, legendEntries, table}) {
    const parts = figure({title, note, legendEntries, table});
    drawn(parts.host, (width) => {
        const height = Math.min(420, Math.max(300, width * 0.5)),
            left = 52,
            top = 26,
            right = width - 26,
            bottom = height - 42;
        const span = (values) => {
            const low = Math.min(...values),
                up = Math.max(...values),
                room = (up - low || up || 1) * 0.08;
            return [Math.max(0, low - room), up + room];
        };
        const x = d3
            .scaleLinear()
            .domain(span(points.map((point) => point.x)))
            .range([left, right])
            .nice();
        const y = d3
            .scaleLinear()
            .domain(span(points.flatMap((p) => [p.y, ...(p.interval || [])])))
            .range([bottom, top])
            .nice();
        const svg = d3
            .create("svg")
            .attr("viewBox", `0 0 ${width} ${height}`)
            .attr("role", "img")
            .attr("aria-labelledby", parts.id);
        const ticks = Math.max(2, Math.floor(width / 110));
        svg.append("g")
            .attr("class", "axis")
            .attr("transform", `translate(0,${bottom})`)
            .call(
                d3
                    .axisBottom(x)
                    .ticks(ticks)
                    .tickSizeInner(top - bottom)
                    .tickSizeOuter(0)
                    .tickPadding(8),
            );
        svg.append("g")
            .attr("class", "axis")
            .attr("transform", `translate(${left},0)`)
            .call(
                d3
                    .axisLeft(y)
                    .ticks(6)
                    .tickSizeInner(left - right)
                    .tickSizeOuter(0)
                    .tickPadding(8),
            );
        svg.append("text")
            .attr("class", "value")
            .attr("x", right)
            .attr("y", height - 4)
            .attr("text-anchor", "end")
            .text(xLabel);
        svg.append("text").attr("class", "value").attr("x", 0).attr("y", 12).text(yLabel);
        for (const point of points) {
            const group = svg.append("g").attr("class", "row");
            group.append("title").text(point.label);
            if (point.interval)
                group
                    .append("path")
                    .attr("class", "whisker")
                    .attr("d", `M${x(point.x)},${y(point.interval[0])}V${y(point.interval[1])}`);
            group
                .append("path")
                .attr("class", `dot ${point.colour}${point.software ? " software" : ""}`)
                .attr("transform", `translate(${x(point.x)},${y(point.y)})`)
                .attr("d", point.shape);
        }
        parts.host.replaceChildren(svg.node());
    });
    return parts.node;
}

// Samples in the order of their recording, rounds told apart by a line.
function sampleStrip(gpu, label) {
    const width = 560,
        height = 84,
        left = 50;
    const x = d3
        .scaleLinear()
        .domain([0, Math.max(1, gpu.samples.length - 1)])
        .range([left + 6, width - 6]);
    const low = Math.min(...gpu.samples),
        up = Math.max(...gpu.samples),
        room = (up - low || up * 0.01 || 1) * 0.1;
    const y = d3
        .scaleLinear()
        .domain([low - room, up + room])
        .range([height - 8, 8]);
    const svg = d3
        .create("svg")
        .attr("viewBox", `0 0 ${width} ${height}`)
        .attr("role", "img")
        .attr("aria-label", label)
        .attr("class", "strip");
    svg.append("g")
        .attr("class", "axis")
        .attr("transform", `translate(${left},0)`)
        .call(
            d3
                .axisLeft(y)
                .ticks(3)
                .tickSizeInner(left - width)
                .tickSizeOuter(0),
        );
    if (gpu.interval)
        svg.append("rect")
            .attr("class", "band")
            .attr("x", left)
            .attr("width", width - left)
            .attr("y", y(gpu.interval[1]))
            .attr("height", Math.max(1, y(gpu.interval[0]) - y(gpu.interval[1])));
    let start = 0;
    for (const size of gpu.roundSizes.slice(0, -1)) {
        start += size;
        svg.append("line")
            .attr("class", "round")
            .attr("x1", x(start - 0.5))
            .attr("x2", x(start - 0.5))
            .attr("y1", 4)
            .attr("y2", height - 4);
    }
    gpu.samples.forEach((sample, i) =>
        svg.append("circle").attr("class", "dot").attr("r", 2).attr("cx", x(i)).attr("cy", y(sample)),
    );
    return svg.node();
}
