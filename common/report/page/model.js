"use strict";
// The result files as checked values, and what follows from them. A file may come from another version of the program
// or from a person, so a value of the wrong kind counts as absent.

const isObject = (value) => value !== null && typeof value === "object" && !Array.isArray(value);
const object = (value) => (isObject(value) ? value : {});
const list = (value) => (Array.isArray(value) ? value : []);
const number = (value) => (typeof value === "number" && Number.isFinite(value) ? value : null);
const numbers = (value) => list(value).filter((entry) => number(entry) !== null);
const text = (value) =>
    typeof value === "string" ? value : value === null || value === undefined ? "" : JSON.stringify(value);

// What the program that made this page knows of every file: the routes, the columns of the table of all cases, and the
// facts that say what a file's cases draw.
const tables = JSON.parse(document.getElementById("tables").textContent);

// Known names first, in their order, others behind them.
function byOrder(order) {
    const place = (name) => (order.includes(name) ? order.indexOf(name) : order.length);
    return (a, b) => place(a) - place(b) || (a < b ? -1 : a > b ? 1 : 0);
}

const unique = (values) => [...new Set(values)];

// The values of an axis in the order of its table, of all files together.
const valuesOf = (axis) =>
    unique(files.flatMap((file) => file.axes.filter(({name}) => name === axis).flatMap(({values}) => values)));
const byAxis = (axis) => byOrder(valuesOf(axis));

function groupBy(values, key) {
    const groups = new Map();
    for (const value of values) {
        const name = key(value);
        if (!groups.has(name)) groups.set(name, []);
        groups.get(name).push(value);
    }
    return groups;
}

function readNumbers(value) {
    const found = {};
    for (const [name, entry] of Object.entries(object(value))) if (number(entry) !== null) found[name] = entry;
    return found;
}

function readInterval(value) {
    const ends = numbers(value);
    return ends.length === 2 && ends[0] <= ends[1] ? ends : null;
}

// Null without a median.
function readTimes(value) {
    const times = object(value);
    if (number(times.median) === null) return null;
    return {
        median: times.median,
        interval: readInterval(times.interval),
        driftP: number(object(times.drift).p),
        samples: numbers(times.samples),
        roundSizes: numbers(times.round_sizes),
    };
}

function readAxis(raw) {
    const axis = object(raw);
    return {
        name: text(axis.name),
        topLevel: axis.top_level === true,
        usual: text(axis.usual),
        values: list(axis.values).map(text),
        beside: text(axis.beside),
    };
}

const onSoftware = (file, route) => file.devices.some((device) => device.software && device.routes.includes(route));
const apiName = (api) => tables.routes.find((route) => route.api === api)?.api_name || api;

const readOptions = (value) =>
    Object.fromEntries(Object.entries(object(value)).map(([name, word]) => [name, text(word)]));

function readCase(raw, file) {
    const row = object(raw),
        options = readOptions(row.options),
        route = text(row.route);
    const result = {
        file,
        raw: row,
        options,
        axes: Object.fromEntries(
            file.axes.map(({name, topLevel}) => [name, topLevel ? text(row[name]) : options[name] || ""]),
        ),
        id: text(row.id),
        route,
        variant: text(row.variant),
        codec: text(row.codec),
        scenario: text(row.scenario),
        raster: text(row.raster),
        status: text(row.status),
        reason: text(row.reason),
        gpu: readTimes(row.gpu_ms),
        passes: readNumbers(row.passes_ms),
        limit: number(row.limit_ms),
        limitId: text(row.limit_id),
        unserialised: readTimes(row.unserialised_ms),
        batch: readTimes(row.batch_ms),
        counters: readNumbers(row.counters),
        memory: isObject(row.memory_bytes) ? readNumbers(row.memory_bytes) : null,
        accuracy: object(row.accuracy),
        software: onSoftware(file, route),
    };
    result.fetch = options.vertex_fetch || "";
    result.views = Number(options.views) || 1;
    result.stage = result.fetch
        ? `${result.variant}, ${result.fetch === "pull" ? "pulling" : "attributes"}`
        : result.variant;
    // Half the copies are not skinned in a frame, so such a case is no rival of the others.
    result.sameWork = !(options.compute || "").split("+").includes("half-rate");
    result.work = workOf(result);
    return result;
}

// What a frame shows. Only cases of the same work are compared.
function workOf(row) {
    const parts = [row.raster || "?", row.scenario || "?"];
    if (row.options.influences) parts.push(`${row.options.influences} influences`);
    if (row.options.back_faces === "kept") parts.push("back faces kept");
    if (row.views > 1) parts.push(`${row.views} views`);
    return parts.join(", ");
}

function readFile(element) {
    const raw = object(JSON.parse(element.textContent));
    const scene = object(raw.scene),
        settings = object(raw.settings);
    const file = {
        element,
        raw,
        scene,
        settings,
        name: element.dataset.name || "",
        host: object(raw.host),
        tool: object(raw.tool),
        warnings: list(raw.warnings).map(text),
        noiseFloor: number(raw.noise_floor),
        selfTest: list(raw.self_test).map(object),
        environment: object(raw.environment),
        limits: list(raw.limits).map(object),
        calibrations: list(raw.calibrations).map(object),
        axes: list(raw.axes).map(readAxis),
        devices: list(raw.devices)
            .map(object)
            .map((device) => ({
                api: text(device.route_api),
                name: text(device.label) || text(device.name),
                uuid: device.software === true ? "" : text(device.uuid),
                driver: text(device.driver),
                version: text(device.version),
                software: device.software === true,
                routes: list(device.routes).map(text),
                peak: readNumbers(device.peak),
            })),
    };
    file.sceneName = text(scene.name) || "unnamed scene";
    file.device = unique(file.devices.map((device) => device.name)).join(" / ") || "no GPU";
    file.cases = list(raw.cases).map((row) => readCase(row, file));
    file.timed = file.cases.filter((row) => row.gpu);
    return file;
}

// Cards of one name in two machines get the beginning of their UUIDs.
function tellDevicesApart(files) {
    const uuidOf = (file) => file.devices.map((device) => device.uuid).find((uuid) => uuid) || "";
    const plain = files.map((file) => file.device);
    files.forEach((file, i) => {
        const others = files.filter((other, k) => plain[k] === plain[i] && uuidOf(other) && uuidOf(other) !== uuidOf(file));
        if (others.length && uuidOf(file)) file.device += ` (UUID ${uuidOf(file).slice(0, 8)}…)`;
    });
}

function readFiles() {
    const files = [...document.querySelectorAll("script.results")].map(readFile);
    tellDevicesApart(files);
    files.forEach((file, index) => {
        file.number = index + 1;
        const shownName = (other) => other.name || other.sceneName;
        const same = files.filter((other) => shownName(other) === shownName(file)).length > 1;
        file.label = same ? `${file.number}: ${shownName(file)}` : shownName(file);
    });
    return files;
}

// As drawnDifferences of report.h.
const drawnDifferences = (a, b) =>
    unique(
        tables.drawn
            .filter(({group, key}) => key in a[group] && key in b[group] && text(a[group][key]) !== text(b[group][key]))
            .map(({group, key}) => (group === "scene" ? "scene" : key.replaceAll("_", " "))),
    );

const fastest = (rows) => rows.reduce((best, row) => (!best || row.gpu.median < best.gpu.median ? row : best), null);

// A bound of the ratio's interval from the ends of both medians' intervals: wider than one from the samples.
function ratioOf(row, base) {
    const ratio = row.gpu.median / base.gpu.median;
    const a = row.gpu.interval,
        b = base.gpu.interval;
    return {ratio, interval: a && b && b[0] > 0 ? [a[0] / b[1], a[1] / b[0]] : null};
}

// The same variant, codec, builder, layout and options on two routes that differ in the API or the extension alone.
function routePairs(rows) {
    const tail = (row) => row.id.slice(row.id.indexOf("/"));
    const drawn = tables.routes.filter(({name}) =>
        rows.some((row) => row.file.devices.some((device) => device.routes.includes(name))),
    );
    const found = [];
    for (const [i, from] of drawn.entries())
        for (const to of drawn.slice(i + 1)) {
            if ((from.api === to.api) === (from.dialect === to.dialect)) continue;
            const bases = new Map(rows.filter((row) => row.route === from.name).map((row) => [tail(row), row]));
            const pairs = rows
                .filter((row) => row.route === to.name && bases.has(tail(row)))
                .map((row) => ({base: bases.get(tail(row)), row, label: tail(row).slice(1)}));
            if (pairs.length) found.push({from: from.name, to: to.name, pairs});
        }
    return found;
}

// Cases of one file that are equal but for one axis, one of them with its usual value. An axis that only means
// something beside some values of that one may differ too.
function choicePairs(rows) {
    const axes = rows.length ? rows[0].file.axes : [],
        found = [];
    for (const axis of axes) {
        const value = (row) => row.axes[axis.name],
            having = rows.filter(value);
        if (!axis.usual || unique(having.map(value)).length < 2) continue;
        const others = axes.filter((other) => other !== axis && other.beside !== axis.name);
        const rest = (row) => JSON.stringify(others.map(({name}) => row.axes[name]));
        const pairs = new Map();
        for (const group of groupBy(having, rest).values()) {
            const base = fastest(group.filter((row) => value(row) === axis.usual));
            if (!base) continue;
            for (const row of group.filter((other) => value(other) !== axis.usual)) {
                if (!pairs.has(value(row))) pairs.set(value(row), []);
                pairs.get(value(row)).push({base, row, label: row.id});
            }
        }
        for (const to of [...pairs.keys()].sort(byOrder(axis.values)))
            found.push({name: axis.name.replaceAll("_", " "), from: axis.usual, to, pairs: pairs.get(to)});
    }
    return found;
}

function medianOf(values) {
    const sorted = [...values].sort((a, b) => a - b),
        half = sorted.length >> 1;
    return sorted.length % 2 ? sorted[half] : (sorted[half - 1] + sorted[half]) / 2;
}

// --- numbers as text ---------------------------------------------------------------------------------------------

const kAbsent = "–";
const fixed = (value, digits) => (value === null || value === undefined ? kAbsent : value.toFixed(digits));
const kGrouped = new Intl.NumberFormat("en-GB");
const kDecimals = [0, 1, 2, 3, 4].map(
    (digits) => new Intl.NumberFormat("en-GB", {minimumFractionDigits: digits, maximumFractionDigits: digits}),
);
const grouped = (value) => (number(value) === null ? kAbsent : kGrouped.format(value));
const decimals = (value, digits) => (number(value) === null ? kAbsent : kDecimals[Math.min(digits, 4)].format(value));
const msText = (value) => fixed(value, value !== null && value < 0.1 ? 4 : value >= 100 ? 2 : 3);
const percentText = (value, digits = 2) => (value === null ? kAbsent : (value * 100).toFixed(digits));
const kibText = (value) => (number(value) === null ? kAbsent : decimals(value / 1024, 1));
const scientific = (value, digits = 1) =>
    number(value) === null ? kAbsent : value === 0 ? "0" : value.toExponential(digits);
// Times of software drivers carry this mark wherever they are printed.
const markOf = (...rows) => (rows.some((row) => row.software) ? "*" : "");
