#include "apps/view/state.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "common/core/text.h"

namespace skinbench::view {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "skinview-settings/1";

// Every key in one place, for reading and for writing: the value, and the range of a number.
template <class Visit>
void visitSettings(ViewState& state, const Visit& visit) {
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
    visit("turn", state.camera.turn, -1e6, 1e6);
    visit("pitch", state.camera.pitch, -89, 89);
    visit("zoom", state.camera.zoom, 1e-3, 1e3);
    visit("moved_x", state.camera.moved.x, -1e6, 1e6);
    visit("moved_y", state.camera.moved.y, -1e6, 1e6);
    visit("moved_z", state.camera.moved.z, -1e6, 1e6);
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
    void operator()(const char* key, const Value& value, Range...) const {
        json[key] = value;
    }
};

struct Reader {
    const Json& json;
    std::string& fault;

    template <class Value>
    void operator()(const char* key, Value& value, double least = 0, double most = 0) const {
        const auto found = json.find(key);
        if (found == json.end()) return;
        auto refuse = [&](const std::string& kind) {
            if (fault.empty()) fault = std::format("'{}' is no {}", key, kind);
        };
        if constexpr (std::is_same_v<Value, std::string> || std::is_same_v<Value, bool>) {
            constexpr bool text = std::is_same_v<Value, std::string>;
            if (text ? !found->is_string() : !found->is_boolean()) return refuse(text ? "text" : "true or false");
            value = found->template get<Value>();
        } else {
            const double number = found->is_number() ? found->template get<double>() : std::nan("");
            const bool whole = std::is_floating_point_v<Value> || number == std::floor(number);
            if (!(number >= least && number <= most && whole))
                return refuse(std::format("{} from {:g} to {:g}", whole ? "number" : "whole number", least, most));
            value = static_cast<Value>(number);
        }
    }
};

Result<void> readCases(ViewState& state, const Json& json) {
    const auto cases = json.find("cases");
    if (cases == json.end()) return {};
    if (!cases->is_array() || cases->size() > 2) return inputError("'cases' is no list of two ids");
    for (size_t i = 0; i < cases->size(); ++i) {
        if (!(*cases)[i].is_string()) return inputError("'cases' is no list of two ids");
        auto parsed = parseCaseId((*cases)[i].get<std::string>());
        SKINBENCH_TRY(parsed);
        state.cases[i] = *parsed;
    }
    return {};
}

}  // namespace

const std::vector<std::string>& modeNames() {
    static const std::vector<std::string> names = {"panes", "wipe", "one", "difference"};
    return names;
}

std::string settingsText(const ViewState& state) {
    Json json{{"schema", kSchema}, {"cases", Json::array()}, {"mode", modeNames()[static_cast<size_t>(state.mode)]}};
    for (const Case& c : state.cases)
        if (c.route) json["cases"].push_back(caseId(c));
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
    SKINBENCH_TRY(readCases(state, json));
    if (const auto mode = json.find("mode"); mode != json.end()) {
        const auto row = std::ranges::find_if(modeNames(), [&](const std::string& word) { return *mode == word; });
        if (row == modeNames().end()) return inputError("'mode' is none of panes, wipe, one, difference");
        state.mode = static_cast<Mode>(row - modeNames().begin());
    }
    return state;
}

void stepClock(ViewState& state, double passed, double duration) {
    if (duration <= 0) {
        state.seconds = 0;
        return;
    }
    state.seconds = std::fmod(state.seconds + passed * state.speed, duration);
    if (state.seconds < 0) state.seconds += duration;
}

}  // namespace skinbench::view
