"use strict";
// What did not run and why, and where and how the rest was measured.

function notRun() {
    const rows = files.flatMap((file) => file.cases).filter((row) => row.status !== "ok");
    if (!rows.length) return note("Every case ran.");
    const groups = [...groupBy(rows, (row) => `${row.status}\n${row.reason}`).values()].sort(
        (a, b) => (a[0].status > b[0].status) - (a[0].status < b[0].status),
    );
    const line = (group) =>
        h(
            "tr",
            {},
            h("td", {class: group[0].status === "failed" ? "failed" : ""}, group[0].status),
            h("td", {class: "why"}, group[0].reason || "no reason recorded"),
            h(
                "td",
                {class: "why"},
                h(
                    "details",
                    {open: group.length <= 6},
                    h("summary", {}, `${group.length} ${group.length === 1 ? "case" : "cases"}`),
                    h("ul", {class: "ids"}, group.map(caseItem)),
                ),
            ),
        );
    const headings = ["status", "reason", "cases"].map((name) => heading(name));
    return h("div", {class: "wide"}, tableOf({}, headings, groups.map(line)));
}

const caseItem = (row) => h("li", {}, h("code", {}, row.id), files.length > 1 ? ` (${row.file.label})` : "");

const valueText = (value) =>
    value === null || value === undefined
        ? kAbsent
        : isObject(value) || Array.isArray(value)
          ? JSON.stringify(value)
          : typeof value === "number" && Number.isInteger(value) && value >= 10_000
            ? grouped(value)
            : typeof value === "number"
              ? String(+value.toPrecision(6))
              : text(value);
const definitions = (entries) =>
    h(
        "dl",
        {class: "context"},
        entries
            .filter(([, value]) => value !== "")
            .flatMap(([name, value]) => [h("dt", {}, name.replaceAll("_", " ")), h("dd", {}, value)]),
    );

function contextOf(file) {
    const parts = [h("h3", {}, files.length > 1 ? file.label : file.sceneName)];
    const column = (title, entries) => h("div", {}, h("h4", {}, title), definitions(entries));
    const pairs = (value) => Object.entries(value).map(([name, entry]) => [name, valueText(entry)]);
    const devices = list(file.raw.devices).map((raw, i) => {
        const {peak, route_api: api, ...rest} = object(raw);
        const shown = ["label", "uuid", "pci", "driver", "version", "software", "timestamp_period_ns", "subgroup_size"]
            .filter((name) => name in rest && rest[name] !== null)
            .map((name) => [name, valueText(rest[name])]);
        const {copy_bytes_per_s: copy, triangles_per_s: triangles} = file.devices[i].peak;
        if (copy) shown.push(["peak copy, GB/s", (copy / 1e9).toFixed(1) + (file.devices[i].software ? "*" : "")]);
        if (triangles)
            shown.push(["peak triangles, 10⁹/s", (triangles / 1e9).toFixed(3) + (file.devices[i].software ? "*" : "")]);
        return column(apiName(text(api)), shown);
    });
    parts.push(
        h(
            "div",
            {class: "columns"},
            devices,
            column("Scene", pairs(file.scene)),
            column("Settings", pairs(file.settings)),
            column("Host and program", [...pairs(file.host), ...pairs(file.tool)]),
            column("Trust", [
                ["noise floor, %", file.noiseFloor === null ? "not measured" : percentText(file.noiseFloor)],
                ["warnings", file.warnings.length ? file.warnings.join("; ") : "none recorded"],
            ]),
        ),
    );
    const simple = (title, head, rows) => (rows.length ? [h("h4", {}, title), plainTable({head, rows})] : []);
    const environment = ["before", "after"].flatMap((when) =>
        list(file.environment[when])
            .map(object)
            .map((e) => [
                when,
                text(e.device) + (e.pci ? ` (${text(e.pci)})` : ""),
                ...["sm_clock_mhz", "memory_clock_mhz", "temperature_c", "power_w"].map((name) => valueText(e[name])),
                valueText(e.power_state),
            ]),
    );
    parts.push(
        ...simple(
            "Clocks, temperature and power",
            ["when", "device", "SM clock MHz", "memory clock MHz", "temperature °C", "power W", "power state"],
            environment,
        ),
    );
    const mark = (id) => (onSoftware(file, text(id).split("/")[0]) ? "*" : "");
    parts.push(
        ...simple(
            "Limits",
            ["id", "status", "median ms", "reason"],
            file.limits.map((limit) => {
                const times = readTimes(limit.gpu_ms);
                return [
                    text(limit.id),
                    text(limit.status),
                    times ? msText(times.median) + mark(limit.id) : kAbsent,
                    text(limit.reason) || kAbsent,
                ];
            }),
        ),
    );
    parts.push(
        ...simple(
            "Self-test: one case timed as two",
            ["case", "first ms", "second ms", "difference %", "equal"],
            file.selfTest.map((test) => [
                text(test.id),
                msText(number(test.a_ms)) + mark(test.id),
                msText(number(test.b_ms)) + mark(test.id),
                percentText(number(test.difference)),
                test.equal === true ? "yes" : test.equal === false ? "no" : kAbsent,
            ]),
        ),
    );
    return parts;
}
