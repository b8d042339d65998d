#include "common/core/file.h"

#include <filesystem>
#include <fstream>

#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace skinbench {
namespace fs = std::filesystem;

Result<void> writeWholeFile(const std::string& path, std::string_view bytes) {
    const fs::path target(path);
    std::error_code failed;
    if (target.has_parent_path()) fs::create_directories(target.parent_path(), failed);
    if (failed) return inputError(path + ": cannot make its folder: " + failed.message());
    if (fs::is_directory(target, failed)) return inputError(path + ": is a folder; name a file");
    const std::string temporary = path + "." + std::to_string(getpid()) + ".part";
    errno = 0;
    std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) {
        const std::string why = errno ? std::strerror(errno) : "unknown error";
        fs::remove(temporary, failed);
        return inputError(path + ": cannot be written: " + why);
    }
    fs::rename(temporary, target, failed);
    if (!failed) return {};
    std::error_code ignored;
    fs::remove(temporary, ignored);
    return inputError(path + ": cannot be written: " + failed.message());
}

Result<std::string> readWholeFile(const std::string& path) {
    std::error_code failed;
    if (fs::is_directory(path, failed)) return inputError(path + ": is a folder; name a file");
    const uintmax_t size = fs::file_size(path, failed);
    if (failed) return inputError(path + ": " + failed.message());
    if (size > uintmax_t{1} << 30) return inputError(path + ": is larger than 1 GiB");
    std::string bytes(size, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(bytes.data(), static_cast<std::streamsize>(size));
    if (!file) return inputError(path + ": cannot be read");
    return bytes;
}

}  // namespace skinbench
