// The panel beside the pictures: controls from the table of axes, the clock, the scene, what was measured.
#include <imgui.h>

#include <algorithm>
#include <format>

#include "apps/view/view.h"
#include "common/cases/choices.h"
#include "common/core/stats.h"

namespace skinbench::view {
namespace {

constexpr size_t kRemembered = 240;  // frames of the graph

std::string spaced(std::string name) {
    std::ranges::replace(name, '_', ' ');
    return name;
}

void text(const std::string& words) { ImGui::TextWrapped("%s", words.c_str()); }

template <class Number>
void slide(const char* name, Number& value, Number least, Number most, const char* format, ImGuiSliderFlags flags = 0) {
    const ImGuiDataType type = std::is_same_v<Number, double> ? ImGuiDataType_Double : ImGuiDataType_U32;
    ImGui::SliderScalar(name, type, &value, &least, &most, format, flags | ImGuiSliderFlags_AlwaysClamp);
}

void button(Viewer& view, const char* name, const char* key) {
    if (ImGui::Button(name)) press(view, key);
}

// --- controls --------------------------------------------------------------------------------------------------

void drawControl(Viewer& view, const Axis& axis) {
    const Case& c = view.state.cases[view.state.active];
    const std::string value = axis.get(c), name = spaced(axis.name);
    if (axis.words.empty()) {  // a number
        std::array<char, 64> words{};
        value.copy(words.data(), words.size() - 1);
        if (ImGui::InputText(name.c_str(), words.data(), words.size(), ImGuiInputTextFlags_EnterReturnsTrue))
            choose(view.state, axis, words.data());
        return;
    }
    if (!ImGui::BeginCombo(name.c_str(), value.c_str())) return;
    const bool joined = joinsWords(c, axis);
    std::string clicked;
    for (const std::string& word : axis.words) {
        const bool now = joined ? ("+" + value + "+").contains("+" + word + "+") : word == value;
        const auto then = chosen(c, axis, word);
        const auto reason = then ? reasonAgainst(*then, view.thread->backends()) : then.error().text;
        ImGui::BeginDisabled(reason && !now);
        if (ImGui::Selectable(word.c_str(), now, joined ? ImGuiSelectableFlags_DontClosePopups : 0)) clicked = word;
        ImGui::EndDisabled();
        if (reason && ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled | ImGuiHoveredFlags_ForTooltip))
            ImGui::SetTooltip("%s", reason->c_str());
    }
    if (!clicked.empty()) choose(view.state, axis, clicked);
    ImGui::EndCombo();
}

void drawCase(Viewer& view) {
    ViewState& state = view.state;
    for (size_t pane = 0; pane < 2; ++pane) {
        if (ImGui::RadioButton(pane == 0 ? "A" : "B", state.active == pane)) state.active = pane;
        ImGui::SameLine();
    }
    ImGui::Checkbox("linked", &state.linked);
    ImGui::SameLine();
    button(view, "swap", "X");
    if (const std::string differing = linkText(state); !differing.empty()) text(differing);
    const auto draw = [&](bool first) {
        for (const Axis* axis : controlsOf(state.cases[state.active]))
            if (first == (axis->inPath || axis->name == "raster" || axis->name == "view")) drawControl(view, *axis);
    };
    draw(true);
    if (!ImGui::TreeNodeEx("more options", ImGuiTreeNodeFlags_SpanAvailWidth)) return;
    draw(false);
    ImGui::TreePop();
}

void drawModes(const Viewer& view, ViewState& state) {
    constexpr std::array kNames = {"side by side", "wipe", "A or B", "difference"};
    for (size_t mode = 0; mode < kNames.size(); ++mode) {
        if (mode % 2) ImGui::SameLine(170 * view.scale);
        if (ImGui::RadioButton(kNames[mode], state.mode == static_cast<Mode>(mode)))
            state.mode = static_cast<Mode>(mode);
    }
    if (state.mode == Mode::difference) slide("times", state.amplify, 1u, 255u, "%u", ImGuiSliderFlags_Logarithmic);
}

void drawClock(Viewer& view) {
    ViewState& state = view.state;
    button(view, state.playing ? "pause" : "play", "Space");
    ImGui::SameLine();
    button(view, "< frame", "Comma");
    ImGui::SameLine();
    button(view, "frame >", "Period");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-FLT_MIN);
    slide("##speed", state.speed, 0.0, 4.0, "speed %.2f");
    ImGui::SetNextItemWidth(-FLT_MIN);
    slide("##seconds", state.seconds, 0.0, view.shown->duration, "%.3f s");
    std::vector<std::string> clips = view.shown->scene.clips;
    clips.push_back("none");
    const std::string chosen = state.clip.empty() ? clips.front() : state.clip;
    const auto nameOf = [](const std::string& clip) { return clip.empty() ? "without a name" : clip; };
    if (!ImGui::BeginCombo("clip", nameOf(chosen).c_str())) return;
    for (const std::string& clip : clips) {
        if (!ImGui::Selectable((nameOf(clip) + "##clip").c_str(), clip == chosen)) continue;
        state.clip = clip;
        state.seconds = 0;
    }
    ImGui::EndCombo();
}

void drawScene(Viewer& view) {
    ViewState& state = view.state;
    text(view.shown->scene.name);
    text(view.shown->scene.text);
    slide("copies", state.copies, 1u, 1000u, "%u", ImGuiSliderFlags_Logarithmic);
    ImGui::ColorEdit3("background", &state.background.x, ImGuiColorEditFlags_NoInputs);
    ImGui::SameLine();
    ImGui::Checkbox("fly", &state.fly);
    ImGui::SameLine();
    button(view, "reset cameras", "Home");
    slide("resolution", state.resolution, 0.0, 1.0, state.resolution > 0 ? "%.2f" : "by device");
    if (state.resolution < 0.05) state.resolution = 0;
    text(std::format("pictures of {} x {}{}", view.size.x, view.size.y,
                     view.shrunk ? ": smaller than the window, as the processor draws them" : ""));
}

// --- measured --------------------------------------------------------------------------------------------------

void drawLegend(const std::vector<LegendRow>& legend) {
    for (const LegendRow& row : legend) {
        const float size = ImGui::GetFontSize();
        ImGui::ColorButton(row.name.c_str(), {row.color.x, row.color.y, row.color.z, 1}, ImGuiColorEditFlags_NoTooltip,
                           {size, size});
        ImGui::SameLine();
        text(row.text);
    }
}

void drawMeasured(Viewer& view) {
    text("What you see here are not bench figures: other work runs beside it.");
    text(std::format("frame {}, {:.1f} a second", view.shown->request.number, 1 / view.period));
    for (size_t pane = 0; pane < 2; ++pane) {
        const CasePicture& picture = view.shown->all[pane];
        const History& history = view.history[pane];
        if (picture.error || history.total.empty()) continue;
        ImGui::PushID(static_cast<int>(pane));
        ImGui::SeparatorText(pane == 0 ? "A" : "B");
        drawLegend(picture.legend);
        ImGui::PlotLines("##graph", history.total.data(), static_cast<int>(history.total.size()), 0,
                         history.figures.c_str(), 0, FLT_MAX, {-FLT_MIN, 48 * view.scale});
        for (const auto& [name, samples] : history.passes)
            text(std::format("{} {:.3f} ms (median of {})", name, summarise(samples).median, samples.size()));
        for (const std::string& line : picture.facts) text(line);
        for (const std::string& line : history.accuracy) text(line);
        ImGui::PopID();
    }
    button(view, "error, counters", "E");
    ImGui::SameLine();
    button(view, "copy as command", "K");
}

}  // namespace

void drawPanel(Viewer& view) {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({view.area.size.x, 0});
    ImGui::SetNextWindowSize({std::max(1.0f, screen.x - view.area.size.x), screen.y});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
    ImGui::Begin("panel", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav);
    ImGui::PopStyleVar(2);
    ImGui::PushItemWidth(190 * view.scale);
    drawModes(view, view.state);
    const auto section = [](const char* name) { return ImGui::CollapsingHeader(name, ImGuiTreeNodeFlags_DefaultOpen); };
    const bool drawn = view.shown && !view.shown->scene.name.empty();
    if (drawn && section("Clock")) drawClock(view);
    if (section("Cases")) drawCase(view);
    if (drawn && section("Scene")) drawScene(view);
    if (drawn && section("Measured")) drawMeasured(view);
    if (!view.picked.empty() && section("Picked"))
        for (const std::string& line : view.picked) text(line);
    button(view, "keys (F1)", "F1");
    ImGui::PopItemWidth();
    ImGui::End();
}

void drawKeys(Viewer& view) {
    ImGui::Begin("Keys", &view.state.keys, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings);
    if (ImGui::BeginTable("keys", 2)) {
        for (const KeyRow& row : keyRows())
            for (const char* cell : {row.shown, row.what}) {
                ImGui::TableNextColumn();
                ImGui::TextUnformatted(cell);
            }
        ImGui::EndTable();
    }
    ImGui::End();
}

void remember(Viewer& view) {
    for (size_t pane = 0; pane < 2; ++pane) {
        const CasePicture& picture = view.shown->all[pane];
        History& history = view.history[pane];
        const std::string id = std::format("{} {} {}", picture.id, view.shown->scene.name, picture.image.width);
        if (history.id != id) history = {.id = id};
        if (!picture.accuracy.empty()) history.accuracy = picture.accuracy;
        if (!picture.picked.empty()) view.picked = picture.picked;
        if (picture.passes.empty()) continue;
        const auto push = [](auto& samples, auto value) {
            if (samples.size() == kRemembered) samples.erase(samples.begin());
            samples.push_back(value);
        };
        for (const auto& [name, ms] : picture.passes) push(history.passes[name], ms);
        push(history.total, static_cast<float>(picture.total));
        const std::vector<double> samples(history.total.begin(), history.total.end());
        const Interval interval = medianInterval(samples, std::array{samples.size()});
        history.figures =
            std::format("{:.3f} ms ({:.3f} to {:.3f})", summarise(samples).median, interval.low, interval.high);
    }
}

}  // namespace skinbench::view
