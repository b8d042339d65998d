"use strict";
// The table of all cases: sorted by its headings, filtered, with the whole record of a case below its row.

const kTableColumns = [
    {name: "case", text: (row) => row.id, words: true},
    {name: "file", text: (row) => row.file.label, words: true},
    {
        name: "median",
        unit: "ms",
        value: (row) => row.gpu?.median,
        text: (row) => row.gpu && msText(row.gpu.median) + markOf(row),
    },
    {
        name: "95 % interval",
        unit: "ms",
        value: (row) => row.gpu?.interval && row.gpu.interval[1] - row.gpu.interval[0],
        text: (row) => row.gpu?.interval && intervalText(row.gpu.interval) + markOf(row),
    },
    {name: "cv", unit: "%", value: (row) => row.gpu?.cv, text: (row) => row.gpu && percentText(row.gpu.cv)},
    {name: "× limit", value: (row) => row.gpu && row.limit && row.gpu.median / row.limit, digits: 3, marked: true},
    {name: "skin", unit: "ms", value: (row) => row.passes.skin, digits: 3, marked: true},
    {name: "depth", unit: "ms", value: (row) => row.passes.depth, digits: 3, marked: true},
    {name: "draw", unit: "ms", value: (row) => row.passes.draw, digits: 3, marked: true},
    {
        name: "memory",
        unit: "KiB a copy",
        value: (row) => row.memory?.total,
        text: (row) => row.memory && kibText(row.memory.total),
    },
    {
        name: "position error",
        value: (row) => row.accuracy.max_position_error,
        text: (row) => scientific(row.accuracy.max_position_error),
    },
    {name: "min", unit: "ms", value: (row) => row.gpu?.min, digits: 3, marked: true, more: "spread"},
    {name: "p95", unit: "ms", value: (row) => row.gpu?.p95, digits: 3, marked: true, more: "spread"},
    {name: "max", unit: "ms", value: (row) => row.gpu?.max, digits: 3, marked: true, more: "spread"},
    {
        name: "drift",
        unit: "%",
        value: (row) => row.gpu?.drift,
        text: (row) => row.gpu && percentText(row.gpu.drift),
        more: "spread",
    },
    {name: "outliers", value: (row) => row.gpu?.outliers, digits: 0, more: "spread"},
    {name: "upload", unit: "ms", value: (row) => row.passes.upload, digits: 3, marked: true, more: "passes"},
    {
        name: "without barriers",
        unit: "ms",
        value: (row) => row.unserialised?.median,
        digits: 3,
        marked: true,
        more: "passes",
    },
    {name: "record", unit: "ms host", value: (row) => row.host.record, digits: 3, more: "host"},
    {name: "submit", unit: "ms host", value: (row) => row.host.submit, digits: 4, more: "host"},
    {
        name: "read",
        unit: "GB/s",
        value: (row) => perBillion(row.achieved.bytes_per_s),
        digits: 1,
        marked: true,
        more: "rates",
    },
    {
        name: "triangles",
        unit: "10⁹/s",
        value: (row) => perBillion(row.achieved.triangles_per_s),
        digits: 3,
        marked: true,
        more: "rates",
    },
    {
        name: "meshlets",
        value: (row) => row.meshlets,
        text: (row) => (row.meshlets === null ? null : grouped(row.meshlets)),
        more: "meshlets",
    },
    {
        name: "normal error",
        unit: "rad",
        value: (row) => row.accuracy.max_normal_error,
        text: (row) => scientific(row.accuracy.max_normal_error),
        more: "accuracy",
    },
    {
        name: "codec position error",
        value: (row) => row.accuracy.codec_position_error,
        text: (row) => scientific(row.accuracy.codec_position_error),
        more: "accuracy",
    },
    ...[
        "input_vertices",
        "vertex_invocations",
        "clipping_primitives",
        "fragment_invocations",
        "compute_invocations",
        "task_invocations",
        "mesh_invocations",
        "mesh_primitives",
    ].map((name) => ({
        name: name.replace("_", " "),
        value: (row) => row.counters[name],
        text: (row) => grouped(row.counters[name]),
        more: "counters",
    })),
    {name: "status", text: (row) => (row.reason ? `${row.status}: ${row.reason}` : row.status), words: true},
];

const perBillion = (value) => (number(value) === null ? null : value / 1e9);
const intervalText = ([low, high]) => `${msText(low)}–${msText(high)}`;

function cellText(column, row) {
    if (column.text) return column.text(row) || kAbsent;
    const value = number(column.value(row));
    return value === null ? kAbsent : value.toFixed(column.digits) + (column.marked ? markOf(row) : "");
}

// Absent values stand last in both directions.
function sorted(rows, column, descending) {
    const key = column.value ? (row) => number(column.value(row)) : (row) => column.text(row);
    const compare = (a, b) => (a < b ? -1 : a > b ? 1 : 0);
    const place = new Map(rows.map((row, i) => [row, i]));
    return [...rows].sort((a, b) => {
        const x = key(a),
            y = key(b);
        if (x === null || y === null) return (x === null) - (y === null) || place.get(a) - place.get(b);
        return (descending ? -1 : 1) * compare(x, y) || place.get(a) - place.get(b);
    });
}

const kFilters = [
    {name: "file", value: (row) => row.file.label},
    {name: "work", value: (row) => row.work},
    {name: "route", value: (row) => row.route},
    {name: "variant", value: (row) => row.variant},
    {name: "codec", value: (row) => row.codec},
    {name: "status", value: (row) => row.status},
];

function recordOf(row) {
    const entries = [];
    const add = (name, value) => {
        if (value) entries.push(h("dt", {}, name), h("dd", {}, value));
    };
    add(
        "options",
        Object.entries(row.options)
            .map(([name, value]) => `${name.replaceAll("_", " ")} ${value}`)
            .join(" · "),
    );
    add(
        "passes, ms",
        Object.entries(row.passes)
            .map(([name, value]) => `${name} ${msText(value)}${markOf(row)}`)
            .join(" · "),
    );
    if (row.memory)
        add(
            "memory, bytes a copy",
            Object.entries(row.memory)
                .filter(([, value]) => value)
                .map(([name, value]) => `${name.replaceAll("_", " ")} ${grouped(value)}`)
                .join(" · "),
        );
    if (row.limit !== null)
        add("limit, ms", `${msText(row.limit)}${markOf(row)}${row.limitId ? ` (${row.limitId})` : ""}`);
    if (row.unserialised)
        add(
            "without barriers, ms",
            msText(row.unserialised.median) +
                markOf(row) +
                (row.unserialised.interval ? ` (${intervalText(row.unserialised.interval)})` : ""),
        );
    add(
        "counters a frame",
        Object.entries(row.counters)
            .map(([name, value]) => `${name.replaceAll("_", " ")} ${grouped(value)}`)
            .join(" · "),
    );
    add(
        "image",
        number(row.accuracy.image_difference) === null
            ? ""
            : `${percentText(row.accuracy.image_difference, 4)} % of the pixels differ from ${text(row.accuracy.image_reference)}`,
    );
    const calibration = row.file.calibrations.find((entry) => text(entry.chosen) === row.id);
    if (calibration)
        add(
            "shapes tried, ms",
            list(calibration.tried)
                .map(object)
                .map((tried) => `${text(tried.id)} ${msText(number(tried.median_ms))}${markOf(row)}`)
                .join(" · "),
        );
    const record = h("dl", {}, entries);
    if (!row.gpu || row.gpu.samples.length < 2) return record;
    const told = row.gpu.driftP === null ? "" : `; rounds differ with p = ${row.gpu.driftP.toPrecision(2)}`;
    return h(
        "div",
        {},
        record,
        h("p", {class: "note"}, `${row.gpu.samples.length} samples in the order of recording, ms${markOf(row)}${told}`),
        sampleStrip(row.gpu, `Samples of ${row.id} in the order of recording`),
    );
}

function caseRow(row, columns) {
    const cells = columns.map((column) => {
        if (column.name === "case") return null;
        const kind = column.words ? "why" : "n";
        return h(
            "td",
            {class: column.name === "status" ? `${kind} ${row.status === "failed" ? "failed" : ""}` : kind},
            cellText(column, row),
        );
    });
    const button = h(
        "button",
        {
            type: "button",
            class: "open",
            "aria-expanded": "false",
            onclick: () => {
                const open = button.getAttribute("aria-expanded") === "true";
                button.setAttribute("aria-expanded", String(!open));
                if (open) line.nextSibling.remove();
                else line.after(h("tr", {class: "record"}, h("td", {colspan: columns.length}, recordOf(row))));
            },
        },
        h("code", {}, row.id),
    );
    const line = h("tr", {class: row.software ? "software" : ""}, h("th", {scope: "row"}, button), cells);
    return line;
}

function caseTable(files) {
    const rows = files.flatMap((file) => file.cases);
    const used = kTableColumns.filter(
        (column) =>
            (column.name !== "file" || files.length > 1) &&
            (column.words || rows.some((row) => number(column.value(row)) !== null)),
    );
    const state = {sort: null, descending: false, search: "", filters: {}, more: new Set()};
    const count = h("p", {class: "note", role: "status"});
    const wide = h("div", {class: "wide tall", tabindex: "0", role: "region", "aria-label": "All cases"});

    const shownRows = () =>
        rows.filter(
            (row) =>
                kFilters.every(({name, value}) => !state.filters[name] || value(row) === state.filters[name]) &&
                state.search.split(/\s+/).every((word) => `${row.id} ${row.reason}`.toLowerCase().includes(word)),
        );

    const heading = (column) => {
        const own = state.sort === column;
        const button = h(
            "button",
            {
                type: "button",
                onclick: () => {
                    state.descending = own ? !state.descending : false;
                    state.sort = column;
                    draw(column);
                },
            },
            column.name,
            column.unit ? h("small", {}, ` ${column.unit}`) : null,
        );
        return h(
            "th",
            {
                scope: "col",
                class: column.words ? "" : "n",
                "aria-sort": own ? (state.descending ? "descending" : "ascending") : "none",
            },
            button,
        );
    };

    function draw(focus) {
        const columns = used.filter((column) => !column.more || state.more.has(column.more));
        const found = state.sort ? sorted(shownRows(), state.sort, state.descending) : shownRows();
        count.textContent = `${found.length} of ${rows.length} cases`;
        wide.replaceChildren(
            h(
                "table",
                {class: "cases"},
                h("caption", {class: "hidden"}, "All cases; a heading sorts, a case's name opens its whole record"),
                h("thead", {}, h("tr", {}, columns.map(heading))),
                h(
                    "tbody",
                    {},
                    found.map((row) => caseRow(row, columns)),
                ),
            ),
        );
        if (focus) wide.querySelectorAll("thead button")[columns.indexOf(focus)].focus();
    }

    const controls = h(
        "div",
        {class: "controls"},
        h(
            "label",
            {},
            "Search ",
            h("input", {
                type: "search",
                placeholder: "case or reason",
                oninput: (event) => {
                    state.search = event.target.value.trim().toLowerCase();
                    draw();
                },
            }),
        ),
    );
    for (const {name, value} of kFilters) {
        const values = unique(rows.map(value)).filter(Boolean);
        if (values.length < 2) continue;
        controls.append(
            h(
                "label",
                {},
                name[0].toUpperCase() + name.slice(1) + " ",
                h(
                    "select",
                    {
                        onchange: (event) => {
                            state.filters[name] = event.target.value;
                            draw();
                        },
                    },
                    h("option", {value: ""}, "all"),
                    values.map((entry) => h("option", {value: entry}, entry)),
                ),
            ),
        );
    }
    const kinds = unique(used.map((column) => column.more).filter(Boolean));
    const columnChoice = h(
        "fieldset",
        {class: "controls"},
        h("legend", {}, "More columns"),
        kinds.map((kind) =>
            h(
                "label",
                {},
                h("input", {
                    type: "checkbox",
                    onchange: (event) => {
                        state.more[event.target.checked ? "add" : "delete"](kind);
                        draw();
                    },
                }),
                ` ${kind}`,
            ),
        ),
    );
    draw();
    return [controls, kinds.length ? columnChoice : null, count, wide];
}
