"use strict";
// Charts of the cases of one file and work, and of several files.

// The id without what the chosen work already says.
const withoutWork = (row) => row.id.replace(`+${row.raster}`, "");
const tailOf = (row) => withoutWork(row).slice(row.id.indexOf("/") + 1);
const variantLegend = (rows) =>
    unique(rows.map((row) => row.variant))
        .sort(byAxis("variant"))
        .map((name) => ({name, colour: variantColour(name)}));

function routeBars(rows, where) {
    const lines = [];
    for (const route of unique(rows.map((row) => row.route)).sort(byAxis("route"))) {
        lines.push({heading: true, label: route, value: ""});
        for (const row of rows.filter((other) => other.route === route).sort((a, b) => a.gpu.median - b.gpu.median))
            lines.push({
                label: tailOf(row),
                value: msCell(row),
                end: row.gpu.median,
                whisker: row.gpu.interval,
                tick: row.limit,
                segments: [{value: row.gpu.median, colour: variantColour(row.variant)}],
                software: row.software,
                row,
                title:
                    `${row.id}: ${msCell(row)} ms` +
                    (row.gpu.interval ? `, 95 % ${intervalText(row.gpu.interval)} ms` : "") +
                    (row.limit ? `, limit ${msText(row.limit)} ms` : ""),
            });
    }
    const timed = rows.some((row) => row.gpu.interval),
        limited = rows.some((row) => row.limit);
    return rowChart({
        title: "Milliseconds a frame, by route",
        rows: lines,
        most: 8,
        legendEntries: variantLegend(rows),
        note:
            `${where}. Median of all copies; ` +
            (timed ? "whiskers: 95 % interval of the median" : "no intervals recorded") +
            (limited ? "; upright tick: the limit, the same draws with nothing fetched and nothing skinned." : "."),
        table: {
            head: ["case", "median ms", "95 % interval ms", "limit ms"],
            row: ({row}) => [
                row.id,
                msCell(row),
                row.gpu.interval ? intervalText(row.gpu.interval) + markOf(row) : kAbsent,
                row.limit ? msText(row.limit) + markOf(row) : kAbsent,
            ],
        },
    });
}

function ratioChart({title, note: words, groups}) {
    const rows = groups.map(({label, pairs}) => {
        const found = pairs.map(({base, row, label: name}) => ({...ratioOf(row, base), base, row, name}));
        const middle = medianOf(found.map(({ratio}) => ratio)),
            single = found.length === 1 ? found[0] : null;
        const marks = markOf(...found.flatMap(({base, row}) => [base, row]));
        return {
            label: `${label} (${found.length})`,
            value: middle.toFixed(3) + marks,
            median: middle,
            end: middle,
            whisker: single ? single.interval : null,
            found,
            software: Boolean(marks),
            dots: found.map(({ratio, row, base}) => ({
                x: ratio,
                colour: variantColour(row.variant),
                title: `${row.id} / ${base.id}: ${ratio.toFixed(3)}${markOf(row, base)}`,
            })),
            title: `${label}: median ratio ${middle.toFixed(3)}${marks} of ${found.length}`,
        };
    });
    const flat = rows.flatMap((row) =>
        row.found.map((pair) => [
            row.label.replace(/ \(\d+\)$/, ""),
            pair.row.id,
            msCell(pair.base),
            msCell(pair.row),
            pair.ratio.toFixed(3) + markOf(pair.row, pair.base),
            pair.interval ? pair.interval.map((end) => end.toFixed(3)).join("–") : kAbsent,
        ]),
    );
    const chart = rowChart({
        title,
        note: words,
        rows,
        ratio: true,
        legendEntries: variantLegend(groups.flatMap(({pairs}) => pairs.map(({row}) => row))),
        table: {head: [], row: () => []},
    });
    const details = h("details", {class: "as-table"}, h("summary", {}, "The same as a table"));
    details.addEventListener("toggle", () => {
        if (details.open && details.children.length === 1)
            details.append(
                plainTable({head: ["choice", "case", "from ms", "to ms", "ratio", "interval at the most"], rows: flat}),
            );
    });
    chart.querySelector("details").replaceWith(details);
    return chart;
}

function apiChart(rows, where) {
    const groups = routePairs(rows).map(({from, to, pairs}) => ({label: `${from} → ${to}`, pairs}));
    if (!groups.length) return null;
    return ratioChart({
        title: "The same case on another API or extension",
        groups,
        note:
            `${where}. Ratio of frame times, second over first: left of 1 the second is faster. ` +
            "A dot is a pair that is equal but for the route; the tick is their median.",
    });
}

function choiceChart(rows, where) {
    const groups = choicePairs(rows).map(({name, from, to, pairs}) => ({label: `${name}: ${from} → ${to}`, pairs}));
    if (!groups.length) return null;
    return ratioChart({
        title: "One choice changed, everything else equal",
        groups,
        note:
            `${where}. Ratio of frame times: left of 1 the second choice is faster. ` +
            "A dot is a pair of cases on one route; the tick is their median.",
    });
}

function codecChart(rows, where) {
    const points = rows.filter((row) => row.memory && number(row.memory.total) !== null && row.variant !== "none");
    if (unique(points.map((row) => row.codec)).length < 2) return null;
    const routes = unique(points.map((row) => row.route)).sort(byAxis("route"));
    return scatterChart({
        title: "What a codec costs: memory against time",
        xLabel: "memory of one copy, KiB",
        yLabel: "milliseconds a frame",
        note: `${where}. Left is smaller, down is faster; colour is the variant, shape the route.`,
        legendEntries: [...variantLegend(points), ...routes.map((route) => ({name: route, shape: routeShape(route)}))],
        points: points.map((row) => ({
            x: row.memory.total / 1024,
            y: row.gpu.median,
            interval: row.gpu.interval,
            colour: variantColour(row.variant),
            shape: routeShape(row.route),
            software: row.software,
            label: `${row.id}: ${kibText(row.memory.total)} KiB, ${msCell(row)} ms`,
        })),
        table: () => ({
            head: ["case", "codec", "KiB a copy", "median ms", "position error"],
            rows: points.map((row) => [
                row.id,
                row.codec,
                kibText(row.memory.total),
                msCell(row),
                scientific(row.accuracy.codec_position_error ?? row.accuracy.max_position_error),
            ]),
        }),
    });
}

function passChart(rows, where) {
    const several = rows
        .filter((row) => Object.keys(row.passes).length > 1)
        .sort((a, b) => a.gpu.median - b.gpu.median);
    if (!several.length) return null;
    const names = unique([...kPasses, ...several.flatMap((row) => Object.keys(row.passes))]).filter((name) =>
        several.some((row) => row.passes[name] !== undefined),
    );
    const sum = (row) => names.reduce((total, name) => total + (row.passes[name] || 0), 0);
    return rowChart({
        title: "Milliseconds a pass",
        most: 16,
        note:
            `${where}. Medians of the passes of cases that have more than one` +
            (several.some((row) => row.unserialised)
                ? "; upright tick: the frame without barriers between the passes of copies."
                : "."),
        legendEntries: names.map((name, i) => ({name, colour: `p-${i % 5}`})),
        rows: several.map((row) => ({
            label: withoutWork(row),
            value: msText(sum(row)) + markOf(row),
            end: sum(row),
            tick: row.unserialised?.median,
            software: row.software,
            row,
            segments: names.map((name, i) => ({value: row.passes[name] || 0, colour: `p-${i % 5}`})),
            title: `${row.id}: ${names.map((name) => `${name} ${msText(row.passes[name] ?? null)}${markOf(row)} ms`).join(", ")}`,
        })),
        table: {
            head: ["case", ...names.map((name) => `${name} ms`), "without barriers ms"],
            row: ({row}) => [
                row.id,
                ...names.map((name) =>
                    row.passes[name] === undefined ? kAbsent : msText(row.passes[name]) + markOf(row),
                ),
                row.unserialised ? msText(row.unserialised.median) + markOf(row) : kAbsent,
            ],
        },
    });
}

function limitChart(rows, where) {
    const limited = rows.filter((row) => row.limit).sort((a, b) => a.gpu.median / a.limit - b.gpu.median / b.limit);
    if (!limited.length) return null;
    const ratio = (row) => row.gpu.median / row.limit;
    return rowChart({
        title: "Ratio to the limit",
        ratio: true,
        most: 16,
        legendEntries: variantLegend(limited),
        note:
            `${where}. Frame time over that of the same draws with nothing fetched and nothing skinned: ` +
            "at 1, fetching and skinning cost nothing.",
        rows: limited.map((row) => ({
            label: withoutWork(row),
            value: ratio(row).toFixed(3) + markOf(row),
            end: ratio(row),
            software: row.software,
            row,
            dots: [{x: ratio(row), colour: variantColour(row.variant), title: row.id}],
        })),
        table: {
            head: ["case", "median ms", "limit ms", "ratio"],
            row: ({row}) => [row.id, msCell(row), msText(row.limit) + markOf(row), ratio(row).toFixed(3) + markOf(row)],
        },
    });
}

// Cases with the same buffers share a bar.
function memoryChart(cases) {
    const rows = cases.filter((row) => row.memory && Object.keys(row.memory).length);
    if (!rows.length) return null;
    const bytes = (row, name) => row.memory[name] || 0;
    const groups = [
        ...groupBy(rows, (row) =>
            JSON.stringify([row.variant, row.codec, kBuffers.map((name) => bytes(row, name))]),
        ).values(),
    ];
    const total = (row) => row.memory.total ?? kBuffers.reduce((sum, name) => sum + bytes(row, name), 0);
    groups.sort((a, b) => total(a[0]) - total(b[0]));
    const names = kBuffers.filter((name) => rows.some((row) => bytes(row, name)));
    return rowChart({
        title: "Memory of one copy by buffer, KiB",
        most: 24,
        legendEntries: names.map((name) => ({name: name.replaceAll("_", " "), colour: `b-${kBuffers.indexOf(name)}`})),
        note: "Cases of one variant and codec whose buffers are equal share a bar; the palette holds one frame.",
        rows: groups.map((group) => ({
            label: group.length === 1 ? group[0].id : `${tailOf(group[0])} and ${group.length - 1} more`,
            value: kibText(total(group[0])),
            end: total(group[0]) / 1024,
            group,
            segments: names.map((name) => ({
                value: bytes(group[0], name) / 1024,
                colour: `b-${kBuffers.indexOf(name)}`,
            })),
            title: group.map((row) => row.id).join("\n"),
        })),
        table: {
            head: ["cases", ...names.map((name) => `${name.replaceAll("_", " ")} KiB`), "total KiB"],
            row: ({group}) => [
                group.map((row) => row.id).join(", "),
                ...names.map((name) => kibText(bytes(group[0], name))),
                kibText(total(group[0])),
            ],
        },
    });
}

function filesChart() {
    const groups = [];
    const first = files[0];
    for (const file of files.slice(1)) {
        const base = new Map(first.timed.map((row) => [row.id, row]));
        const pairs = file.timed
            .filter((row) => base.has(row.id))
            .map((row) => ({base: base.get(row.id), row, label: row.id}));
        for (const [route, own] of groupBy(pairs, ({row}) => row.route))
            groups.push({label: `${file.label}: ${route}`, pairs: own});
    }
    if (!groups.length) return [];
    const others = files
        .map((file) => ({file, differ: drawnDifferences(first, file).join(", ")}))
        .filter(({differ}) => differ);
    const warnings = others.map(({file, differ}) =>
        h(
            "p",
            {class: "banner"},
            h("strong", {}, "Warning: "),
            `${file.label} does not draw what ${first.label} draws (${differ}): ` +
                "its ratios say nothing about which is faster.",
        ),
    );
    const chart = ratioChart({
        title: `Ratio to ${first.label}`,
        groups,
        note:
            `The same case in each file over that in ${first.label}; left of 1 is faster` +
            `${others.length ? " where the same is drawn" : ""}. ` +
            '"skinbench compare" tells differences from noise.',
    });
    return [...warnings, chart];
}

// Every setting, device and fact of the scene that is not the same in all files, with its values.
function differencesTable() {
    const facts = (file) => {
        const devices = file.devices.map(
            (device) =>
                `${apiName(device.api)}: ${device.name}, ${device.driver}${device.uuid ? `, UUID ${device.uuid}` : ""}`,
        );
        const groups = {scene: file.scene, settings: file.settings, host: file.host, tool: file.tool};
        return new Map([
            ["devices", devices.join("; ") || "none"],
            // Words of an option that the file's cases have, such as codec: uc, pc.
            ...file.axes.map(({name}) => [
                `cases: ${name.replaceAll("_", " ")}`,
                unique(file.cases.map((row) => row.axes[name]).filter((value) => value)).sort().join(", ") || kAbsent,
            ]),
            ...Object.entries(groups).flatMap(([group, values]) =>
                Object.entries(values).map(([name, value]) => [`${group}: ${name.replaceAll("_", " ")}`, valueText(value)]),
            ),
        ]);
    };
    const known = files.map(facts);
    const rows = unique(known.flatMap((values) => [...values.keys()]))
        .map((name) => [name, ...known.map((values) => values.get(name) ?? kAbsent)])
        .filter(([, ...values]) => unique(values).length > 1);
    return rows.length
        ? [
              note("The files differ in:"),
              h("div", {class: "differences"}, plainTable({head: ["", ...files.map((file) => file.label)], rows})),
          ]
        : [note("Scene, devices, settings and revision are the same in all files.")];
}
