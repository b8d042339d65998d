"use strict";
// Time against the number of views, and where one variant overtakes another.

const workOfOneView = (row) => workOf({...row, views: 1});

// The fastest case of each variant on an API at each number of views, of those that have several.
function viewLines(rows, api) {
    const onApi = rows.filter((row) => tables.routes.find(({name}) => name === row.route)?.api === api);
    const lines = [...groupBy(onApi, (row) => row.variant)].map(([variant, own]) => ({
        variant,
        points: [...groupBy(own, (row) => row.views)]
            .sort(([a], [b]) => a - b)
            .map(([views, cases]) => ({views, row: fastest(cases)})),
    }));
    return lines
        .filter(({points}) => points.length > 1)
        .sort((a, b) => byAxis("variant")(a.variant, b.variant));
}

// By how much `a` is slower than `b`, and between which values both intervals let that lie.
function leadOf(a, b) {
    const ends = a.gpu.interval && b.gpu.interval;
    return {
        middle: a.gpu.median - b.gpu.median,
        low: ends ? a.gpu.interval[0] - b.gpu.interval[1] : null,
        high: ends ? a.gpu.interval[1] - b.gpu.interval[0] : null,
    };
}

// Where the straight line from (from, first) to (to, last) is 0; held at an end that it does not reach.
function zeroBetween(from, to, first, last) {
    if (first <= 0) return from;
    return last >= 0 ? to : from + ((to - from) * first) / (first - last);
}

// Between two numbers of views that both have, time is taken as a straight line. An end of the interval where a number
// was not enough to tell the two apart is open.
function crossingsOf(one, other) {
    const shared = one.points
        .map(({views, row}) => ({views, one: row, other: other.points.find((point) => point.views === views)?.row}))
        .filter((point) => point.other);
    const found = [];
    for (let i = 1; i < shared.length; ++i) {
        const [from, to] = [shared[i - 1], shared[i]];
        const before = leadOf(from.one, from.other),
            after = leadOf(to.one, to.other);
        if (before.middle >= 0 === after.middle >= 0) continue;
        const slower = before.middle >= 0 ? "one" : "other",
            faster = slower === "one" ? "other" : "one";
        const first = leadOf(from[slower], from[faster]),
            last = leadOf(to[slower], to[faster]);
        const at = (key) => zeroBetween(from.views, to.views, first[key], last[key]);
        found.push({
            overtakes: slower === "one" ? one : other,
            overtaken: slower === "one" ? other : one,
            views: at("middle"),
            interval: first.low === null || last.low === null ? null : [at("low"), at("high")],
            open: [first.low !== null && first.low <= 0, last.high !== null && last.high >= 0],
            software: [from.one, from.other, to.one, to.other].some((row) => row.software),
        });
    }
    return found;
}

function allCrossings(lines) {
    return lines
        .flatMap((one, i) => lines.slice(i + 1).flatMap((other) => crossingsOf(one, other)))
        .sort((a, b) => a.views - b.views);
}

const crossingInterval = ({interval, open}) =>
    interval
        ? `${open[0] ? "≤ " : ""}${interval[0].toFixed(2)} to ${open[1] ? "≥ " : ""}${interval[1].toFixed(2)}`
        : kAbsent;

function drawLines(host, lines, id, width) {
    const height = Math.min(420, Math.max(300, width * 0.5)),
        [left, top, right, bottom] = [52, 26, width - 26, height - 42];
    const points = lines.flatMap((line) => line.points);
    const x = d3
        .scaleLinear()
        .domain([1, Math.max(...points.map(({views}) => views))])
        .range([left + 8, right]);
    const y = d3
        .scaleLinear()
        .domain([0, Math.max(...points.map(({row}) => Math.max(row.gpu.median, ...(row.gpu.interval || []))))])
        .range([bottom, top])
        .nice();
    const svg = d3
        .create("svg")
        .attr("viewBox", `0 0 ${width} ${height}`)
        .attr("role", "img")
        .attr("aria-labelledby", id);
    const axis = (made, at, from, to) =>
        svg
            .append("g")
            .attr("class", "axis")
            .attr("transform", at)
            .call(made.tickSizeInner(from - to).tickSizeOuter(0).tickPadding(8));
    const counts = unique(points.map(({views}) => views));
    axis(d3.axisBottom(x).tickValues(counts).tickFormat(String), `translate(0,${bottom})`, top, bottom);
    axis(d3.axisLeft(y).ticks(6), `translate(${left},0)`, left, right);
    const words = (text, at, anchor) =>
        svg
            .append("text")
            .attr("class", "value")
            .attr("x", at[0])
            .attr("y", at[1])
            .attr("text-anchor", anchor)
            .text(text);
    words("views", [right, height - 4], "end");
    words("milliseconds a frame", [0, 12], "start");
    for (const {variant, points: own} of lines) {
        const colour = variantColour(variant),
            path = own.map(({views, row}, i) => `${i ? "L" : "M"}${x(views)},${y(row.gpu.median)}`).join("");
        svg.append("path").attr("class", `line ${colour}`).attr("d", path);
        for (const {views, row} of own) {
            const group = svg.append("g").attr("class", "row");
            group.append("title").text(`${row.id}: ${msCell(row)} ms`);
            if (row.gpu.interval)
                group
                    .append("path")
                    .attr("class", "whisker")
                    .attr("d", `M${x(views)},${y(row.gpu.interval[0])}V${y(row.gpu.interval[1])}`);
            group
                .append("circle")
                .attr("class", `dot ${colour}`)
                .attr("cx", x(views))
                .attr("cy", y(row.gpu.median))
                .attr("r", 4.5);
        }
    }
    host.replaceChildren(svg.node());
}

function viewsChart(lines, name, where) {
    const parts = figure({
        title: `Milliseconds a frame by the number of views, ${name}`,
        note: `${where}. Each variant's fastest case at each number of views.`,
        legendEntries: lines.map(({variant}) => ({name: variant, colour: variantColour(variant)})),
        table: () => ({
            head: ["variant", "views", "case", "median ms", "95 % interval ms"],
            rows: lines.flatMap(({variant, points}) =>
                points.map(({views, row}) => [
                    variant,
                    String(views),
                    row.id,
                    msCell(row),
                    row.gpu.interval ? intervalText(row.gpu.interval) + markOf(row) : kAbsent,
                ]),
            ),
        }),
    });
    drawn(parts.host, (width) => drawLines(parts.host, lines, parts.id, width));
    return parts.node;
}

// Of the cases that do such work in any number of views.
function viewsSection(rows, work, where) {
    const own = rows.filter((row) => skins(row) && workOfOneView(row) === work);
    return unique(tables.routes.map(({api}) => api)).flatMap((api) => {
        const lines = viewLines(own, api);
        if (!lines.length) return [];
        const crossings = allCrossings(lines);
        const cells = (crossing) => [
            crossing.overtakes.variant,
            crossing.overtaken.variant,
            crossing.views.toFixed(2) + (crossing.software ? "*" : ""),
            crossingInterval(crossing),
        ];
        return [
            viewsChart(lines, apiName(api), where),
            crossings.length
                ? plainTable({
                      head: ["faster with more views", "faster with fewer", "crossing, views", "95 % interval"],
                      rows: crossings.map(cells),
                  })
                : null,
            note(
                crossings.length
                    ? "A crossing lies between two measured numbers of views, where time is taken as a straight line. " +
                          "Its interval is the widest that those of the medians allow; ≤ or ≥ stands where a measured " +
                          "number does not tell the two apart. Other pairs do not cross."
                    : "No variant overtakes another between the measured numbers of views.",
            ),
        ];
    });
}
