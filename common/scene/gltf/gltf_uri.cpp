#include "common/scene/gltf/gltf_uri.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <format>
#include <fstream>
#include <string_view>

#include "common/core/utf8.h"

namespace skinbench {
namespace {

constexpr uint64_t kMaxFileBytes = 0xFFFFFFFFu;

int hexDigit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

std::string decodePercent(std::string_view uri) {
    std::string path;
    for (size_t i = 0; i < uri.size(); ++i) {
        const bool escape =
            uri[i] == '%' && i + 2 < uri.size() && hexDigit(uri[i + 1]) >= 0 && hexDigit(uri[i + 2]) >= 0;
        path += escape ? static_cast<char>(hexDigit(uri[i + 1]) * 16 + hexDigit(uri[i + 2])) : uri[i];
        if (escape) i += 2;
    }
    return path;
}

// RFC 3986, section 3.1; a single letter is a drive.
bool hasScheme(std::string_view uri) {
    const size_t colon = uri.find(':');
    if (colon == uri.npos || colon < 2 || !std::isalpha(static_cast<unsigned char>(uri[0]))) return false;
    return std::ranges::all_of(uri.substr(0, colon),
                               [](unsigned char c) { return std::isalnum(c) || c == '+' || c == '-' || c == '.'; });
}

bool isBelow(const std::filesystem::path& path, const std::filesystem::path& folder) {
    const auto [end, stop] = std::ranges::mismatch(folder, path);
    return end == folder.end();
}

Result<std::vector<uint8_t>> decodeBase64(std::string_view text) {
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::array<int8_t, 256> value;
    value.fill(-1);
    for (size_t i = 0; i < kDigits.size(); ++i) value[static_cast<uint8_t>(kDigits[i])] = static_cast<int8_t>(i);
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    std::vector<uint8_t> bytes;
    bytes.reserve(text.size() * 3 / 4);
    uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        const int digit = value[static_cast<uint8_t>(c)];
        if (digit < 0) return inputError("its data URI is not base64");
        bits = bits << 6 | static_cast<uint32_t>(digit);
        count += 6;
        if (count >= 8) {
            count -= 8;
            bytes.push_back(static_cast<uint8_t>(bits >> count));
        }
    }
    return bytes;
}

// Case counts neither in schemes nor in media types' parameters.
std::string lower(std::string_view text) {
    std::string out(text);
    std::ranges::transform(out, out.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return out;
}

}  // namespace

Result<std::vector<uint8_t>> readGltfBytes(const std::filesystem::path& path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) return inputError("there is no such file");
    if (std::filesystem::is_directory(status)) return inputError("is a folder, not a glTF file");
    if (!std::filesystem::is_regular_file(status)) return inputError("is not a regular file");
    const uint64_t size = std::filesystem::file_size(path, error);
    if (error) return inputError("cannot be read: " + error.message());
    if (size > kMaxFileBytes) return inputError(std::format("has {} bytes; 4 GiB is the limit of glTF binaries", size));
    std::ifstream stream(path, std::ios::binary);
    std::vector<uint8_t> bytes(size);
    if (!stream) return inputError("cannot be opened; check its permissions");
    if (size > 0 && !stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
        return inputError("cannot be read to its end");
    constexpr std::string_view kPointer = "version https://git-lfs.github.com/spec/";
    if (std::string_view(reinterpret_cast<const char*>(bytes.data()), size).starts_with(kPointer))
        return inputError("is a Git LFS pointer, not the file itself; fetch it with git lfs pull");
    return bytes;
}

bool isDataUri(const std::string& uri) { return lower(std::string_view(uri).substr(0, 5)) == "data:"; }

Result<std::vector<uint8_t>> decodeDataUri(const std::string& uri) {
    const size_t comma = uri.find(',');
    if (comma == uri.npos || !lower(std::string_view(uri).substr(0, comma)).ends_with(";base64"))
        return inputError("its data URI is not base64");
    return decodeBase64(std::string_view(uri).substr(comma + 1));
}

Result<std::filesystem::path> resolveUri(const std::string& uri, const std::filesystem::path& folder) {
    namespace fs = std::filesystem;
    const auto refused = [&](const char* why) { return inputError("its uri \"" + shortText(uri, 80) + "\" " + why); };
    if (hasScheme(uri)) return refused("is no path of a local file; only files beside the glTF file are read");
    std::string text = uri;
    std::ranges::replace(text, '\\', '/');
    text = decodePercent(text);
    if (text.empty() || text.find('\0') != text.npos) return refused("is no path of a local file");
    if (text[0] == '/' || text[0] == '\\' || (text.size() > 1 && text[1] == ':'))
        return refused("is absolute; only files beside the glTF file are read");
    for (size_t begin = 0; begin <= text.size();) {
        const size_t end = std::min(text.find_first_of("/\\", begin), text.size());
        if (text.compare(begin, end - begin, "..") == 0)
            return refused("holds \"..\"; only files beside the glTF file are read");
        begin = end + 1;
    }
    const fs::path given = (folder.empty() ? fs::path(".") : folder) / text;
    std::error_code error;
    if (!fs::exists(given, error)) return inputError(shortText(text, 200) + ": there is no such file");
    const fs::path path = fs::canonical(given, error), home = fs::canonical(folder.empty() ? "." : folder, error);
    if (error) return inputError(shortText(text, 200) + ": cannot be read: " + error.message());
    if (!isBelow(path, home)) return refused("is a link that leaves the glTF file's folder");
    return path;
}

}  // namespace skinbench
