"use strict";
// The top of the page and what it found: the fastest paths, and every stage on every route.

const kSoftwareNote = "* software driver: shows that a path works, not how fast a GPU is";

function section(id, title, ...content) {
    const found = content.flat().filter(Boolean);
    return found.length
        ? h("section", {id, "aria-labelledby": `${id}-title`}, h("h2", {id: `${id}-title`}, title), found)
        : null;
}

const note = (...words) => h("p", {class: "note"}, words);
const msCell = (row) => msText(row.gpu.median) + markOf(row);
const scope = (file, work) => `${file.label}, ${work}`;

// "3.2 % faster than" only where the intervals do not touch.
function leadText(best, next) {
    const {ratio} = ratioOf(next, best);
    const name = `${next.route} ${next.stage}`;
    if (best.gpu.interval && next.gpu.interval && best.gpu.interval[1] >= next.gpu.interval[0])
        return `not told apart from ${name}`;
    const known = best.gpu.interval && next.gpu.interval;
    return `next ${name}: +${((ratio - 1) * 100).toFixed(1)} %${markOf(best, next)}${known ? "" : ", no intervals"}`;
}

function contextLine(file) {
    const {scene, settings} = file;
    const rounds =
        number(settings.rounds) === null ? "" : ` in ${settings.rounds} ${settings.rounds === 1 ? "round" : "rounds"}`;
    const facts = [
        `${grouped(scene.vertices)} vertices`,
        `${grouped(scene.triangles)} triangles`,
        `${grouped(scene.joints)} joints`,
        `${grouped(settings.copies)} copies`,
        `${text(settings.width)} × ${text(settings.height)}`,
        `${grouped(settings.frames)} frames${rounds}`,
    ];
    return facts.join(" · ");
}

// Files are named as the one who made the page typed them: a path, or a folder.
function downloadName(file) {
    const last = file.name.split("/").filter(Boolean).pop() || "results";
    return last.endsWith(".json") ? last : `${last}.json`;
}

function downloadButton(file) {
    return h(
        "button",
        {
            type: "button",
            class: "download",
            onclick: () => {
                const address = URL.createObjectURL(
                    new Blob([file.element.textContent + "\n"], {type: "application/json"}),
                );
                const link = h("a", {href: address, download: downloadName(file)});
                link.click();
                setTimeout(() => URL.revokeObjectURL(address), 10_000);
            },
        },
        files.length > 1 ? file.name || `results ${file.number}` : "Download JSON",
    );
}

function pageHead(host) {
    const one = files.length === 1 ? files[0] : null;
    const devices = unique(files.map((file) => file.device)),
        scenes = unique(files.map((file) => file.sceneName));
    const several = (names, what) => (names.length === 1 ? names[0] : `${names.length} ${what}`);
    const title = one
        ? `${one.sceneName} on ${one.device}`
        : `${several(scenes, "scenes")} on ${several(devices, "devices")}`;
    document.title = `${title} – skinbench`;
    const drivers = unique(files.flatMap((file) => file.devices.map((d) => `${apiName(d.api)}: ${d.driver}`)));
    host.append(
        h("p", {class: "brand"}, "skinbench report"),
        h("h1", {}, title),
        one
            ? h("p", {class: "facts"}, contextLine(one))
            : h(
                  "p",
                  {class: "facts"},
                  `${files.length} result files · ${files.reduce((sum, file) => sum + file.timed.length, 0)} timed cases`,
              ),
        h("p", {class: "note"}, drivers.join(" · "), one ? ` · revision ${text(one.tool.revision)}` : ""),
        h(
            "div",
            {class: "downloads"},
            files.length > 1 ? h("span", {class: "note"}, "Download JSON ") : null,
            files.length > 5
                ? h("details", {}, h("summary", {}, `${files.length} files`), files.map(downloadButton))
                : files.map(downloadButton),
        ),
    );
    const software = unique(
        files.flatMap((file) =>
            file.devices.filter((d) => d.software).map((d) => `${d.name} (${apiName(d.api)})`),
        ),
    );
    if (software.length)
        host.append(
            h(
                "p",
                {class: "banner"},
                h("strong", {}, "Software driver: "),
                `${software.join(", ")} ${software.length > 1 ? "run" : "runs"} on the CPU. ` +
                    "Such times show that a path works, not how fast a GPU is. They are marked *, their bars are dashed.",
            ),
        );
    for (const file of files)
        for (const warning of file.warnings)
            host.append(
                h(
                    "p",
                    {class: "banner"},
                    h("strong", {}, "Warning: "),
                    files.length > 1 ? `${file.label}: ` : "",
                    warning,
                ),
            );
}

function works(file) {
    const order = byAxis("raster");
    return unique(file.timed.map((row) => row.work)).sort(
        (a, b) => order(a.split(",")[0], b.split(",")[0]) || (a < b ? -1 : 1),
    );
}

const skins = (row) => row.variant !== "none" && row.sameWork && row.route !== "cpu";

function findingsTable() {
    const variants = unique(
        files
            .flatMap((file) => file.timed)
            .filter(skins)
            .map((row) => row.variant),
    ).sort(byAxis("variant"));
    const lines = files
        .flatMap((file) => works(file).map((work) => findingsLine(file, work, variants)))
        .filter(Boolean);
    if (!lines.length) return null;
    const headings = [
        heading("scene and work"),
        heading("fastest case"),
        numberHeading("of the fastest vertex", "×"),
        variants.map((variant) => numberHeading([swatch(variant), variant], "ms")),
    ].flat();
    return region("Fastest paths", tableOf({class: "findings"}, headings, lines));
}

const swatch = (variant) => h("span", {class: `swatch ${variantColour(variant)}`});

function findingsLine(file, work, variants) {
    const rivals = file.timed.filter((row) => row.work === work && skins(row));
    const best = fastest(rivals);
    if (!best) return null;
    const others = rivals.filter((row) => row.variant !== best.variant || row.route !== best.route);
    const next = fastest(others),
        vertex = fastest(rivals.filter((row) => row.variant === "vertex"));
    const cell = (variant) => {
        const row = fastest(rivals.filter((rival) => rival.variant === variant));
        const leads = row && variant === best.variant && !best.software;
        return h(
            "td",
            {class: `n ${leads ? "best" : ""}`, title: row ? row.id : null},
            row ? msCell(row) : kAbsent,
            h("small", {}, row ? row.route : ""),
        );
    };
    return h(
        "tr",
        {},
        h(
            "th",
            {scope: "row"},
            files.length > 1 ? file.label : file.sceneName,
            h("small", {}, `${files.length > 1 ? `${file.device}, ` : ""}${work}`),
        ),
        h(
            "td",
            {class: "why"},
            caseName(withoutWork(best)),
            h("small", {}, next ? leadText(best, next) : "the only one"),
        ),
        h(
            "td",
            {class: "n"},
            vertex && vertex !== best ? ratioOf(best, vertex).ratio.toFixed(3) + markOf(best, vertex) : kAbsent,
        ),
        variants.map(cell),
    );
}

// Fastest case of a stage on a route, with its ratio to a baseline that the reader chooses.
function stageMatrix(rows) {
    const routes = unique(rows.map((row) => row.route)).sort(byAxis("route"));
    const stages = unique(rows.map((row) => row.stage)).sort(
        (a, b) => byAxis("variant")(a.split(",")[0], b.split(",")[0]) || (a < b ? -1 : 1),
    );
    const cells = stages.map((stage) =>
        routes.map((route) =>
            fastest(rows.filter((row) => row.stage === stage && row.route === route && row.sameWork)),
        ),
    );
    const found = cells.flat().filter(Boolean);
    if (!found.length) return [];
    const longest = Math.max(...found.map((row) => row.gpu.median)),
        least = fastest(found.filter(skins));
    const host = region("Stages by route");
    let base = found.find((row) => row.stage === "vertex, attributes") || found.find(skins) || found[0];
    const cell = (row) => {
        if (!row) return h("td", {class: "n"}, kAbsent);
        const bar = `cell-bar ${variantColour(row.variant)}${row.software ? " software" : ""}`,
            width = `width:${((row.gpu.median / longest) * 100).toFixed(1)}%`,
            ratio = row === base ? "baseline" : `${ratioOf(row, base).ratio.toFixed(3)} ×${markOf(row, base)}`;
        return h(
            "td",
            {class: `n ${row === least && !row.software ? "best" : ""}`, title: row.id},
            h("span", {class: bar, style: width, "aria-hidden": "true"}),
            msCell(row),
            h("small", {}, ratio),
        );
    };
    const line = (row, i) =>
        h("tr", {}, h("th", {scope: "row"}, swatch(stages[i].split(",")[0]), stages[i]), row.map(cell));
    const headings = [heading("stage"), ...routes.map((route) => numberHeading(route, "ms"))];
    const draw = () => host.replaceChildren(tableOf({class: "matrix"}, headings, cells.map(line)));
    draw();
    const choice = h(
        "label",
        {},
        "Ratios to ",
        h(
            "select",
            {
                onchange: (event) => {
                    base = found[Number(event.target.value)];
                    draw();
                },
            },
            found.map((row, i) => h("option", {value: i, selected: row === base}, `${row.route} ${row.stage}`)),
        ),
    );
    return [
        note(
            "The fastest case of each stage on each route; the pointer on a figure shows which. ",
            h("em", {}, "none"),
            " skins nothing: the cost of the draw alone.",
        ),
        h("div", {class: "controls"}, choice),
        host,
    ];
}
