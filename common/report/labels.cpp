#include "common/report/labels.h"

#include <algorithm>
#include <optional>
#include <ranges>

namespace skinbench {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts;
    for (const auto part : std::views::split(text, separator)) parts.emplace_back(part.begin(), part.end());
    return parts;
}

std::string meshletsOf(const IdParts& id) {
    std::string text;
    for (size_t i = 3; i < id.path.size(); ++i) text += (text.empty() ? "" : "/") + id.path[i];
    return text;
}

// The one text of all that have one, or nothing.
struct Common {
    std::optional<std::string> text;
    bool differ = false;

    void add(const std::string& other) {
        if (other.empty()) return;
        differ = differ || (text && *text != other);
        text = other;
    }
    std::string value() const { return differ ? "" : text.value_or(""); }
};

bool contains(const std::vector<std::string>& list, const std::string& word) {
    return std::ranges::find(list, word) != list.end();
}

}  // namespace

IdParts readIdParts(const std::string& id) {
    IdParts parts;
    parts.options = split(id, '+');
    if (parts.options.empty()) return parts;
    parts.path = split(parts.options.front(), '/');
    parts.options.erase(parts.options.begin());
    return parts;
}

SharedParts sharedParts(const std::vector<std::string>& ids) {
    SharedParts shared;
    if (ids.size() < 2) return shared;
    Common codec, meshlets;
    std::optional<std::vector<std::string>> options;
    for (const std::string& id : ids) {
        const IdParts parts = readIdParts(id);
        codec.add(parts.path.size() > 2 ? parts.path[2] : "");
        meshlets.add(meshletsOf(parts));
        if (!options) options = parts.options;
        std::erase_if(*options, [&](const std::string& option) { return !contains(parts.options, option); });
    }
    return {codec.value(), meshlets.value(), *options};
}

SharedParts withWork(SharedParts shared, const std::string& work) {
    for (const auto part : std::views::split(work, std::string_view(", ")))
        shared.options.emplace_back(part.begin(), part.end());
    return shared;
}

std::string sharedText(const SharedParts& shared) {
    std::vector<std::string> parts;
    if (!shared.codec.empty()) parts.push_back("/" + shared.codec);
    if (!shared.meshlets.empty()) parts.push_back("with meshlets /" + shared.meshlets);
    for (const std::string& option : shared.options) parts.push_back("+" + option);
    std::string text;
    for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
    return text;
}

std::string shortName(const std::string& id, const SharedParts& shared) {
    const IdParts parts = readIdParts(id);
    std::string name = parts.path.size() > 1 ? parts.path[1] : id;
    if (parts.path.size() > 2 && parts.path[2] != shared.codec) name += "/" + parts.path[2];
    if (const std::string meshlets = meshletsOf(parts); !meshlets.empty() && meshlets != shared.meshlets)
        name += "/" + meshlets;
    for (const std::string& option : parts.options)
        if (!contains(shared.options, option)) name += "+" + option;
    return name;
}

}  // namespace skinbench
