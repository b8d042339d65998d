"use strict";
// The table of all cases: sorted by its headings, filtered, with the whole record of a case below its row.

const intervalText = ([low, high]) => `${msText(low)}–${msText(high)}`;
const valueAt = (row, path) => path.split(".").reduce((holder, key) => object(holder)[key], row.raw);

// An interval counts by its width.
function numberAt(row, path) {
    const ends = readInterval(valueAt(row, path));
    return ends ? ends[1] - ends[0] : number(valueAt(row, path));
}

// A row of the program's table of columns; common/report/columns.h says what its values mean.
function tableColumn({path, per, scale, form, digits, header, unit, group, marked}) {
    const value = (row) => {
        const own = numberAt(row, path),
            by = per ? numberAt(row, per) : 1;
        return own === null || !(by > 0) ? null : (own / by) * scale;
    };
    const printed = {
        fixed: (row) => decimals(value(row), digits),
        milliseconds: (row) => msText(value(row)),
        scientific: (row) => scientific(value(row), digits),
        ends: (row) => intervalText(readInterval(valueAt(row, path))),
    }[form];
    return {
        name: header,
        unit,
        more: group,
        value,
        text: (row) => (value(row) === null ? null : printed(row) + (marked ? markOf(row) : "")),
    };
}

const kTableColumns = [
    {name: "case", text: (row) => row.id, words: true},
    {name: "file", text: (row) => row.file.label, words: true},
    ...tables.columns.map(tableColumn),
    {name: "status", text: (row) => (row.reason ? `${row.status}: ${row.reason}` : row.status), words: true},
];

const cellText = (column, row) => column.text(row) || kAbsent;

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
    const frames = {"without barriers, ms": row.unserialised, "in a batch, ms": row.batch};
    for (const [name, times] of Object.entries(frames))
        if (times)
            add(
                name,
                msText(times.median) + markOf(row) + (times.interval ? ` (${intervalText(times.interval)})` : ""),
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
