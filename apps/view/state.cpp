#include "apps/view/state.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "common/core/text.h"

namespace skinbench::view {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "skinview-settings/1";

template <class Visit>
void visitCamera(const std::string& name, CameraMove& camera, const Visit& visit) {
    visit(name + "turn", camera.turn, -1e6, 1e6);
    visit(name + "pitch", camera.pitch, -89, 89);
    visit(name + "zoom", camera.zoom, 1e-3, 1e3);
    for (int i = 0; i < 3; ++i) visit(name + "moved_" + "xyz"[i], camera.moved[i], -1e6, 1e6);
}

// Every key in one place, for reading and for writing: the value, and the range of a number.
template <class Visit>
void visitSettings(ViewState& state, const Visit& visit) {
    visit("case", state.cases[0]);
    visit("case2", state.cases[1]);
    visit("mode", state.mode);
    visit("scene", state.scene);
    visit("active", state.active, 0, 1);
    visit("linked", state.linked);
    visit("splitter", state.splitter, 0, 1);
    visit("amplify", state.amplify, 1, 255);
    visit("clip", state.clip);
    visit("seconds", state.seconds, 0, 1e6);
    visit("playing", state.playing);
    visit("speed", state.speed, -16, 16);
    visit("copies", state.copies, 1, 1'000'000);
    visit("fly", state.fly);
    visitCamera("", state.camera, visit);
    visitCamera("overview_", state.overview, visit);
    visit("red", state.background.x, 0, 1);
    visit("green", state.background.y, 0, 1);
    visit("blue", state.background.z, 0, 1);
    visit("width", state.width, 1, 16384);
    visit("height", state.height, 1, 16384);
    visit("resolution", state.resolution, 0, 1);
    visit("dark", state.dark);
    visit("panel", state.panel);
}

struct Writer {
    Json& json;

    template <class Value, class... Range>
    void operator()(const std::string& key, const Value& value, Range...) const {
        if constexpr (std::is_same_v<Value, Mode>)
            json[key] = modeNames()[static_cast<size_t>(value)];
        else if constexpr (!std::is_same_v<Value, Case>)
            json[key] = value;
        else if (value.route)
            json[key] = caseId(value);
    }
};

struct Reader {
    const Json& json;
    std::string& fault;  // of the first key that cannot be

    template <class Value>
    void operator()(const std::string& key, Value& value, double least = 0, double most = 0) const {
        if (!fault.empty() || !json.contains(key)) return;
        const Json& given = json[key];
        const std::string word = given.is_string() ? given.get<std::string>() : dumpJson(given, -1);
        const auto holds = [&](bool right, const std::string& kind) {
            if (!right) fault = std::format("'{}' is {}", key, kind);
            return right;
        };
        if constexpr (std::is_same_v<Value, std::string>) {
            if (holds(given.is_string(), "no text")) value = word;
        } else if constexpr (std::is_same_v<Value, bool>) {
            if (holds(given.is_boolean(), "no true or false")) value = given;
        } else if constexpr (std::is_same_v<Value, Mode>) {
            if (holds(std::ranges::contains(modeNames(), word), "none of panes, wipe, one, difference"))
                value = modeOf(word);
        } else if constexpr (std::is_same_v<Value, Case>) {
            const auto parsed = parseCaseId(word);
            if (holds(parsed.has_value(), "no case: " + (parsed ? "" : parsed.error().text))) value = *parsed;
        } else {
            const double number = given.is_number() ? given.get<double>() : std::nan("");
            const bool whole = std::is_floating_point_v<Value> || number == std::floor(number);
            const std::string kind =
                std::format("no {} from {:g} to {:g}", whole ? "number" : "whole number", least, most);
            if (holds(number >= least && number <= most && whole, kind)) value = static_cast<Value>(number);
        }
    }
};

}  // namespace

const std::vector<std::string>& modeNames() {
    static const std::vector<std::string> names = {"panes", "wipe", "one", "difference"};
    return names;
}

Mode modeOf(const std::string& name) {
    return static_cast<Mode>(std::ranges::find(modeNames(), name) - modeNames().begin());
}

std::string settingsText(const ViewState& state) {
    Json json{{"schema", kSchema}};
    ViewState copy = state;
    visitSettings(copy, Writer{json});
    return dumpJson(json) + "\n";
}

Result<ViewState> readSettings(ViewState state, const std::string& text) {
    SKINBENCH_TRY(checkJsonShape(text));
    const Json json = Json::parse(text, nullptr, false);
    if (!json.is_object() || json.value("schema", Json()) != kSchema)
        return inputError(std::format("no settings of skinview: there is no \"schema\": \"{}\"", kSchema));
    std::string fault;
    visitSettings(state, Reader{json, fault});
    if (!fault.empty()) return inputError(fault);
    return state;
}

void stepClock(ViewState& state, double passed, double duration) {
    state.seconds = duration > 0 ? std::fmod(state.seconds + passed * state.speed, duration) : 0;
    if (state.seconds < 0) state.seconds += duration;
}

}  // namespace skinbench::view
