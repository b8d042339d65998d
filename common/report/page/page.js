"use strict";
// The sections in their order, the most important first.

function chosenCharts() {
    const state = {file: files.find((file) => file.timed.length) || files[0], work: "", codec: ""};
    const host = h("div", {});
    const controls = h("div", {class: "controls sticky", role: "group", "aria-label": "What the charts show"});
    const select = (label, values, current, change) =>
        values.length < 2
            ? null
            : h(
                  "label",
                  {},
                  label,
                  " ",
                  h(
                      "select",
                      {onchange: (event) => change(values[event.target.selectedIndex])},
                      values.map((value) => h("option", {selected: value === current}, value.label || value || "all")),
                  ),
              );
    const redraw = (focus) => {
        const found = works(state.file);
        const size = (work) => state.file.timed.filter((row) => row.work === work).length;
        if (!found.includes(state.work))
            state.work = found.reduce((best, work) => (size(work) > size(best) ? work : best), found[0] || "");
        const inWork = state.file.timed.filter((row) => row.work === state.work);
        const codecs = unique(inWork.map((row) => row.codec));
        if (!codecs.includes(state.codec)) state.codec = "";
        const ofCodec = state.file.timed.filter((row) => !state.codec || row.codec === state.codec);
        const rows = ofCodec.filter((row) => row.work === state.work);
        const codec = state.codec ? `, codec ${state.codec}` : "",
            where = scope(state.file, state.work) + codec,
            work = rows.length ? workOfOneView(rows[0]) : "";
        const change = (name, label) => (value) => {
            state[name] = value;
            redraw(label);
        };
        const choices = [
            ["File", "file", files],
            ["Work", "work", found],
            ["Codec", "codec", codecs.length > 1 ? ["", ...codecs] : []],
        ];
        controls.replaceChildren(
            ...choices
                .map(([label, name, values]) => select(label, values, state[name], change(name, label)))
                .filter(Boolean),
        );
        if (focus)
            [...controls.querySelectorAll("label")]
                .find((label) => label.textContent.startsWith(focus))
                ?.querySelector("select")
                .focus();
        host.replaceChildren(
            ...(rows.length
                ? [
                      section(
                          "stages",
                          "Vertex, compute or mesh",
                          note(`${where}, milliseconds a frame.`),
                          stageMatrix(rows),
                          routeBars(rows, where),
                      ),
                      section("apis", "Vulkan or OpenGL, EXT or NV", apiChart(rows, where)),
                      section("choices", "What each choice does", choiceChart(rows, where)),
                      section("views", "Several views", viewsSection(ofCodec, work, scope(state.file, work) + codec)),
                      section("codecs", "Codecs", codecChart(inWork, scope(state.file, state.work))),
                      section("passes", "Passes and limits", passChart(rows, where), limitChart(rows, where)),
                  ]
                : [note("No case of this file has a time.")]
            ).filter(Boolean),
        );
        const memory = section("memory", "Memory", memoryChart(state.file.cases));
        if (memory) host.append(memory);
        contents();
    };
    redraw();
    return h("div", {}, controls, host);
}

function contents() {
    const sections = [...document.querySelectorAll("main section")];
    document.getElementById("contents").replaceChildren(
        h(
            "ul",
            {},
            sections.map((part) => h("li", {}, h("a", {href: `#${part.id}`}, part.querySelector("h2").textContent))),
        ),
    );
}

const files = readFiles();
pageHead(document.getElementById("top"));
const anyCodecs = files.some((file) => unique(file.timed.map((row) => row.codec)).length > 1);
const anySoftware = files.some((file) => file.devices.some((device) => device.software));
document
    .getElementById("main")
    .append(
        ...[
            section(
                "fastest",
                "Fastest path",
                findingsTable() || note("No case has a time."),
                note(
                    "Milliseconds a frame for all copies, median; each variant's fastest case, and the ratio of the " +
                        "fastest of all to the fastest case of the variant vertex on any API. Every case was checked " +
                        "against a double-precision CPU reference before it was timed.",
                    anyCodecs
                        ? " Codecs are rivals here, though they differ in accuracy; the table of all cases shows it."
                        : "",
                    anySoftware ? ` ${kSoftwareNote}.` : "",
                ),
            ),
            section("files", "Files compared", files.length > 1 ? [...filesChart(), ...differencesTable()] : null),
            chosenCharts(),
            section("cases", "All cases", caseTable(files), anySoftware ? note(kSoftwareNote) : null),
            section("not-run", "Skipped and failed", notRun()),
            section("context", "Context", files.flatMap(contextOf)),
        ].filter(Boolean),
    );
contents();
