// The panel beside the pictures: controls from the table of axes, the clock, the scene, what was measured.
#include <imgui.h>

#include <algorithm>
#include <format>

#include "apps/view/view.h"
#include "common/core/stats.h"

namespace skinbench::view {
namespace {

constexpr size_t kRemembered = 240;  // frames of the graph

std::string spaced(std::string name) {
    std::ranges::replace(name, '_', ' ');
    return name;
}

void reasonAsTooltip(const std::optional<std::string>& reason) {
    if (reason && ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled | ImGuiHoveredFlags_ForTooltip))
        ImGui::SetTooltip("%s", reason->c_str());
}

// --- controls --------------------------------------------------------------------------------------------------

void drawChoices(Viewer& view, const Control& control) {
    const auto flags = control.joined ? ImGuiSelectableFlags_DontClosePopups : ImGuiSelectableFlags_None;
    if (!ImGui::BeginCombo(spaced(control.axis->name).c_str(), control.value.c_str())) return;
    for (const ControlChoice& choice : control.choices) {
        const bool chosen = control.joined ? ("+" + control.value + "+").contains("+" + choice.word + "+")
                                           : choice.word == control.value;
        ImGui::BeginDisabled(choice.reason && !chosen);
        if (ImGui::Selectable(choice.word.c_str(), chosen, flags))
            choose(view.state, view.state.active, *control.axis, choice.word);
        ImGui::EndDisabled();
        reasonAsTooltip(choice.reason);
    }
    ImGui::EndCombo();
}

// Numbers, and whatever else has no list.
void drawText(Viewer& view, const Control& control) {
    std::array<char, 64> text{};
    control.value.copy(text.data(), text.size() - 1);
    if (ImGui::InputText(spaced(control.axis->name).c_str(), text.data(), text.size(),
                         ImGuiInputTextFlags_EnterReturnsTrue))
        choose(view.state, view.state.active, *control.axis, text.data());
}

void drawCase(Viewer& view) {
    ViewState& state = view.state;
    for (size_t pane = 0; pane < 2; ++pane) {
        if (pane) ImGui::SameLine();
        if (ImGui::RadioButton(pane == 0 ? "A" : "B", state.active == pane)) state.active = pane;
    }
    ImGui::SameLine();
    ImGui::Checkbox("linked", &state.linked);
    ImGui::SameLine();
    if (ImGui::Button("swap")) std::swap(state.cases[0], state.cases[1]);
    if (!state.cases[state.active].route) return;
    const std::vector<Control> controls = controlsOf(state.cases[state.active], view.renderer->devices());
    const auto draw = [&](bool first) {
        for (const Control& control : controls) {
            const bool usual = control.axis->inPath || control.axis->name == "raster" || control.axis->name == "view";
            if (usual == first) control.choices.empty() ? drawText(view, control) : drawChoices(view, control);
        }
    };
    draw(true);
    if (!ImGui::TreeNodeEx("more options", ImGuiTreeNodeFlags_SpanAvailWidth)) return;
    draw(false);
    ImGui::TreePop();
}

void drawModes(ViewState& state) {
    constexpr std::array kNames = {"side by side", "wipe", "A or B", "difference"};
    for (size_t mode = 0; mode < kNames.size(); ++mode) {
        if (mode % 2) ImGui::SameLine(170);
        if (ImGui::RadioButton(kNames[mode], state.mode == static_cast<Mode>(mode)))
            state.mode = static_cast<Mode>(mode);
    }
    auto amplify = static_cast<int>(state.amplify);
    if (state.mode == Mode::difference &&
        ImGui::SliderInt("times", &amplify, 1, 255, "%d", ImGuiSliderFlags_Logarithmic))
        state.amplify = static_cast<uint32_t>(std::clamp(amplify, 1, 255));
}

void drawClock(Viewer& view) {
    ViewState& state = view.state;
    if (ImGui::Button(state.playing ? "pause" : "play")) state.playing = !state.playing;
    ImGui::SameLine();
    for (const double step : {-1.0 / 60, 1.0 / 60}) {
        if (ImGui::Button(step < 0 ? "< frame" : "frame >")) {
            state.playing = false;
            state.seconds = std::max(0.0, state.seconds + step);
        }
        ImGui::SameLine();
    }
    auto speed = static_cast<float>(state.speed);
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (ImGui::SliderFloat("##speed", &speed, 0, 4, "speed %.2f")) state.speed = speed;
    auto seconds = static_cast<float>(state.seconds);
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (ImGui::SliderFloat("##seconds", &seconds, 0, static_cast<float>(view.shown->duration), "%.3f s"))
        state.seconds = seconds;
    const std::vector<ClipInfo>& clips = view.shown->clips;
    const std::string chosen = !state.clip.empty() ? state.clip : clips.empty() ? "none" : clips.front().name;
    const auto nameOf = [](const std::string& clip) { return clip.empty() ? "without a name" : clip; };
    if (!ImGui::BeginCombo("clip", nameOf(chosen).c_str())) return;
    for (const ClipInfo& clip : clips) {
        if (!ImGui::Selectable((nameOf(clip.name) + "##clip").c_str(), clip.name == chosen)) continue;
        state.clip = clip.name;
        state.seconds = 0;
    }
    if (ImGui::Selectable("none##clip", chosen == "none")) state.clip = "none";
    ImGui::EndCombo();
}

void drawScene(Viewer& view) {
    ViewState& state = view.state;
    const SceneStats& stats = view.shown->stats;
    ImGui::TextWrapped("%s", view.shown->scene.c_str());
    ImGui::TextWrapped("%s", std::format("{} vertices, {} triangles, {} joints, {:.2f} influences a vertex",
                                         stats.vertices, stats.triangles, stats.joints, stats.meanInfluences)
                                 .c_str());
    auto copies = static_cast<int>(state.copies);
    if (ImGui::SliderInt("copies", &copies, 1, 1000, "%d", ImGuiSliderFlags_Logarithmic))
        state.copies = static_cast<uint32_t>(std::clamp(copies, 1, 1000));
    ImGui::ColorEdit3("background", &state.background.x, ImGuiColorEditFlags_NoInputs);
    ImGui::SameLine();
    ImGui::Checkbox("fly", &state.fly);
    ImGui::SameLine();
    if (ImGui::Button("reset camera")) state.camera = {};
    auto resolution = static_cast<float>(state.resolution);
    if (ImGui::SliderFloat("resolution", &resolution, 0, 1, resolution > 0 ? "%.2f" : "by device"))
        state.resolution = resolution < 0.05f ? 0 : resolution;
    ImGui::TextWrapped("%s", std::format("pictures of {} x {}{}", view.size.x, view.size.y,
                                         view.shrunk ? ": smaller than the window, as the processor draws them" : "")
                                 .c_str());
}

// --- measured --------------------------------------------------------------------------------------------------

std::string kibText(uint64_t bytes) { return std::format("{:.1f}", static_cast<double>(bytes) / 1024); }

std::string memoryText(const MemoryBytes& memory) {
    const std::array<std::pair<const char*, uint64_t>, 7> kinds = {{{"vertex", memory.vertex},
                                                                    {"index", memory.index},
                                                                    {"meshlet", memory.meshlet},
                                                                    {"more of meshlets", memory.additionalMeshlet},
                                                                    {"tuple", memory.tuple},
                                                                    {"palette", memory.palette},
                                                                    {"skinned", memory.skinned}}};
    std::string text = kibText(memory.total()) + " KiB a copy:";
    for (const auto& [name, bytes] : kinds)
        if (bytes) text += std::format(" {} {}", name, kibText(bytes));
    return text;
}

void drawLegend(const std::vector<LegendRow>& legend) {
    for (const LegendRow& row : legend) {
        const ImVec4 color(row.color.x, row.color.y, row.color.z, 1);
        const float size = ImGui::GetFontSize();
        ImGui::ColorButton(row.name.c_str(), color, ImGuiColorEditFlags_NoTooltip, {size, size});
        ImGui::SameLine();
        ImGui::TextWrapped("%s", row.text.c_str());
    }
}

void drawMeasured(Viewer& view) {
    ImGui::TextWrapped("What you see here are not bench figures: other work runs beside it.");
    ImGui::TextWrapped("%s", std::format("frame {}, {:.1f} a second", view.shown->number, 1 / view.period).c_str());
    for (size_t pane = 0; pane < 2; ++pane) {
        const Drawn& picture = view.shown->pictures[pane];
        const History& history = view.history[pane];
        if (!picture.error.empty() || history.total.empty()) continue;
        ImGui::SeparatorText(pane == 0 ? "A" : "B");
        ImGui::PushID(static_cast<int>(pane));
        drawLegend(picture.legend);
        ImGui::PopID();
        ImGui::PlotLines(pane == 0 ? "##graph A" : "##graph B", history.total.data(),
                         static_cast<int>(history.total.size()), 0, history.figures.c_str(), 0, FLT_MAX,
                         {-FLT_MIN, 48 * view.scale});
        for (const auto& [name, samples] : history.passes)
            ImGui::TextWrapped(
                "%s",
                std::format("{} {:.3f} ms (median of {})", name, summarise(samples).median, samples.size()).c_str());
        ImGui::TextWrapped("%s", memoryText(picture.memory).c_str());
        if (picture.meshlets)
            ImGui::TextWrapped("%s", std::format("{} meshlets: {:.1f} vertices, {:.1f} triangles, {:.1f} tuples each; "
                                                 "each vertex {:.2f} times",
                                                 picture.meshlets->meshlets, picture.meshlets->meanVertices,
                                                 picture.meshlets->meanTriangles, picture.meshlets->meanUniqueTuples,
                                                 picture.meshlets->vertexReuse)
                                         .c_str());
        if (!view.accuracy[pane].empty()) ImGui::TextWrapped("%s", view.accuracy[pane].c_str());
    }
    if (ImGui::Button("error, counters")) view.askAccuracy = true;
    ImGui::SameLine();
    if (!ImGui::Button("copy as command")) return;
    ImGui::SetClipboardText(benchCommand(view.state).c_str());
    view.note = "copied: " + benchCommand(view.state);
}

}  // namespace

void drawPanel(Viewer& view) {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({view.area.size.x, 0});
    ImGui::SetNextWindowSize({std::max(1.0f, screen.x - view.area.size.x), screen.y});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
    ImGui::Begin("panel", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav);
    ImGui::PopStyleVar();
    ImGui::PushItemWidth(190 * view.scale);
    drawModes(view.state);
    const auto section = [](const char* name) { return ImGui::CollapsingHeader(name, ImGuiTreeNodeFlags_DefaultOpen); };
    const bool drawn = view.shown && !view.shown->scene.empty();
    if (drawn && section("Clock")) drawClock(view);
    if (section("Cases")) drawCase(view);
    if (drawn) {
        if (section("Scene")) drawScene(view);
        if (section("Measured")) drawMeasured(view);
        if (!view.picked.empty() && section("Picked"))
            for (const std::string& line : view.picked) ImGui::TextWrapped("%s", line.c_str());
    }
    if (ImGui::Button("keys (F1)")) view.state.keys = !view.state.keys;
    ImGui::PopItemWidth();
    ImGui::End();
}

void drawKeys(Viewer& view) {
    ImGui::Begin("Keys", &view.state.keys, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings);
    if (ImGui::BeginTable("keys", 2)) {
        const auto row = [](const char* key, const char* what) {
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(key);
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(what);
        };
        for (const KeyRow& key : keyRows()) row(key.shown, key.what);
        row("drag", "orbit; right button: move; wheel: nearer, farther");
        row("click", "what lies there: meshlet and vertex");
        row("arrows", "move; Page Up and Page Down: up and down");
        row("drop", "a .glb or .gltf file on the window");
        ImGui::EndTable();
    }
    ImGui::End();
}

void remember(Viewer& view) {
    for (size_t pane = 0; pane < 2; ++pane) {
        const Drawn& picture = view.shown->pictures[pane];
        History& history = view.history[pane];
        const std::string id = std::format("{} {} {}", picture.id, view.shown->scene, picture.image.width);
        if (history.id != id) {
            history = {.id = id};
            view.accuracy[pane].clear();
        }
        if (!picture.accuracy.empty()) view.accuracy[pane] = picture.accuracy;
        if (!picture.picked.empty()) view.picked = picture.picked;
        if (picture.passes.empty()) continue;
        const auto push = [](auto& samples, double value) {
            if (samples.size() == kRemembered) samples.erase(samples.begin());
            samples.push_back(static_cast<std::remove_reference_t<decltype(samples[0])>>(value));
        };
        double total = 0;
        for (const auto& [name, ms] : picture.passes) {
            total += ms;
            push(history.passes[name], ms);
        }
        push(history.total, total);
        const std::vector<double> samples(history.total.begin(), history.total.end());
        const std::array sizes{samples.size()};
        const Interval interval = medianInterval(samples, sizes);
        history.figures =
            std::format("{:.3f} ms ({:.3f} to {:.3f})", summarise(samples).median, interval.low, interval.high);
    }
}

}  // namespace skinbench::view
