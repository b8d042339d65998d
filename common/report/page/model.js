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

const kVariants = ["none", "vertex", "palette", "compute", "mesh", "mesh-ci", "cpu"];
const kRoutes = ["vk", "gl", "vk-ext", "vk-nv", "gl-nv", "gl-ext", "cpu"];
const kRasters = ["full", "no-fragments", "discard"];

// Known names first, in their order, others behind them.
function byOrder(order) {
    const place = (name) => (order.includes(name) ? order.indexOf(name) : order.length);
    return (a, b) => place(a) - place(b) || (a < b ? -1 : a > b ? 1 : 0);
}

const unique = (values) => [...new Set(values)];

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
    const drift = object(times.drift);
    return {
        median: times.median,
        mean: number(times.mean),
        min: number(times.min),
        max: number(times.max),
        cv: number(times.cv),
        p95: number(times.p95),
        interval: readInterval(times.interval),
        outliers: number(times.outliers),
        drift: number(drift.relative),
        driftP: number(drift.p),
        samples: numbers(times.samples),
        roundSizes: numbers(times.round_sizes),
    };
}

function readCase(raw, file) {
    const row = object(raw);
    const options = {};
    for (const [name, value] of Object.entries(object(row.options))) options[name] = text(value);
    const api = text(row.route).startsWith("vk") ? "vulkan" : text(row.route).startsWith("gl") ? "opengl" : "";
    const result = {
        file,
        options,
        id: text(row.id),
        route: text(row.route),
        variant: text(row.variant),
        codec: text(row.codec),
        builder: text(row.builder),
        layout: text(row.layout),
        cull: text(row.cull),
        scenario: text(row.scenario),
        raster: text(row.raster),
        status: text(row.status),
        reason: text(row.reason),
        gpu: readTimes(row.gpu_ms),
        passes: readNumbers(row.passes_ms),
        limit: number(row.limit_ms),
        limitId: text(row.limit_id),
        achieved: readNumbers(row.achieved),
        unserialised: readTimes(row.unserialised_ms),
        host: readNumbers(row.host_ms),
        counters: readNumbers(row.counters),
        meshlets: number(row.meshlets),
        memory: isObject(row.memory_bytes) ? readNumbers(row.memory_bytes) : null,
        accuracy: object(row.accuracy),
        software: file.devices.some((device) => device.api === api && device.software),
    };
    result.fetch = options.vertex_fetch || "";
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
        devices: list(raw.devices)
            .map(object)
            .map((device) => ({
                api: text(device.route_api),
                name: text(device.name),
                driver: text(device.driver),
                version: text(device.version),
                software: device.software === true,
                peak: readNumbers(device.peak),
            })),
    };
    file.sceneName = text(scene.name) || "unnamed scene";
    file.device = unique(file.devices.map((device) => device.name)).join(" / ") || "no GPU";
    file.cases = list(raw.cases).map((row) => readCase(row, file));
    file.timed = file.cases.filter((row) => row.gpu);
    return file;
}

function readFiles() {
    const files = [...document.querySelectorAll("script.results")].map(readFile);
    files.forEach((file, index) => {
        file.number = index + 1;
        const shownName = (other) => other.name.replace(/\.json$/, "") || other.sceneName;
        const same = files.filter((other) => shownName(other) === shownName(file)).length > 1;
        file.label = same ? `${file.number}: ${shownName(file)}` : shownName(file);
    });
    return files;
}

const fastest = (rows) => rows.reduce((best, row) => (!best || row.gpu.median < best.gpu.median ? row : best), null);

// A bound of the ratio's interval from the ends of both medians' intervals: wider than one from the samples.
function ratioOf(row, base) {
    const ratio = row.gpu.median / base.gpu.median;
    const a = row.gpu.interval,
        b = base.gpu.interval;
    return {ratio, interval: a && b && b[0] > 0 ? [a[0] / b[1], a[1] / b[0]] : null};
}

const kRoutePairs = [
    ["vk", "gl"],
    ["vk-ext", "vk-nv"],
    ["vk-ext", "gl-ext"],
    ["vk-nv", "gl-nv"],
    ["gl-ext", "gl-nv"],
];

// The same variant, codec, builder, layout and options on two routes.
function routePairs(rows) {
    const tail = (row) => row.id.slice(row.id.indexOf("/"));
    const found = [];
    for (const [from, to] of kRoutePairs) {
        const bases = new Map(rows.filter((row) => row.route === from).map((row) => [tail(row), row]));
        const pairs = rows
            .filter((row) => row.route === to && bases.has(tail(row)))
            .map((row) => ({base: bases.get(tail(row)), row, label: tail(row).slice(1)}));
        if (pairs.length) found.push({from, to, pairs});
    }
    return found;
}

// What may be changed alone: its value in a case, the value it is compared with, and options that only exist beside
// some of its values.
const option = (name) => (row) => row.options[name];
const kChoices = [
    {name: "codec", base: "uc", value: (row) => row.codec},
    {name: "vertex fetch", base: "attributes", value: option("vertex_fetch"), without: ["vertex_fetch"]},
    {name: "culling", base: "off", value: (row) => row.cull, without: ["exchange"]},
    {name: "records", base: "indexed", value: option("records"), without: ["records"]},
    {name: "palette", base: "storage", value: option("palette"), without: ["palette"]},
    {name: "joints", base: "vertex", value: option("joints"), without: ["joints"]},
    {name: "loads", base: "guarded", value: option("loads"), without: ["loads"]},
    {name: "layout", base: "redirect", value: (row) => row.layout},
    {name: "builder", base: "meshopt", value: (row) => row.builder},
    {
        name: "meshlet limits",
        base: "64/124",
        without: ["meshlet_vertices", "meshlet_triangles"],
        value: (row) =>
            row.options.meshlet_vertices && `${row.options.meshlet_vertices}/${row.options.meshlet_triangles}`,
    },
    {name: "group size", base: "32", value: option("group_size"), without: ["group_size"]},
    {name: "index writes", base: "packed", value: option("index_writes"), without: ["index_writes"]},
    {name: "submission", base: "per-copy", value: option("submission"), without: ["submission"]},
    {name: "compute options", base: "plain", value: option("compute"), without: ["compute"]},
    {name: "palette slots", base: "32", value: option("palette_slots"), without: ["palette_slots"]},
];

function choicePairs(rows) {
    const found = [];
    for (const choice of kChoices) {
        const rest = (row) => {
            const options = Object.entries(row.options).filter(([name]) => !(choice.without || []).includes(name));
            const fixed = [row.route, row.variant, row.raster, row.scenario];
            for (const [name, value] of [
                ["codec", row.codec],
                ["culling", row.cull],
                ["layout", row.layout],
                ["builder", row.builder],
            ])
                fixed.push(choice.name === name ? "" : value);
            return JSON.stringify([fixed, options.sort()]);
        };
        const pairs = new Map(),
            having = rows.filter((row) => choice.value(row));
        if (unique(having.map(choice.value)).length < 2) continue;
        for (const group of groupBy(having, rest).values()) {
            const base = fastest(group.filter((row) => choice.value(row) === choice.base));
            if (!base) continue;
            for (const row of group.filter((other) => choice.value(other) !== choice.base)) {
                const to = choice.value(row);
                if (!pairs.has(to)) pairs.set(to, []);
                pairs.get(to).push({base, row, label: row.id});
            }
        }
        for (const [to, entries] of pairs) found.push({name: choice.name, from: choice.base, to, pairs: entries});
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
const kWhole = new Intl.NumberFormat("en-GB"),
    kTenths = new Intl.NumberFormat("en-GB", {minimumFractionDigits: 1, maximumFractionDigits: 1});
const grouped = (value) => (number(value) === null ? kAbsent : kWhole.format(value));
const msText = (value) => fixed(value, value !== null && value < 0.1 ? 4 : value >= 100 ? 2 : 3);
const percentText = (value, digits = 2) => (value === null ? kAbsent : (value * 100).toFixed(digits));
const kibText = (value) => (number(value) === null ? kAbsent : kTenths.format(value / 1024));
const scientific = (value) => (number(value) === null ? kAbsent : value === 0 ? "0" : value.toExponential(1));
// Times of software drivers carry this mark wherever they are printed.
const markOf = (...rows) => (rows.some((row) => row.software) ? "*" : "");
