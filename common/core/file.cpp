#include "common/core/file.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <format>
#include <optional>
#include <random>
#include <utility>

namespace skinbench {
namespace fs = std::filesystem;

namespace {

constexpr size_t kLargestInput = size_t{1} << 30;
constexpr int kSilence = 60'000;  // milliseconds that a pipe may say nothing

struct Descriptor {
    int number = -1;
    explicit Descriptor(int number) : number(number) {}
    Descriptor(Descriptor&& other) noexcept : number(std::exchange(other.number, -1)) {}
    Descriptor& operator=(Descriptor&&) = delete;
    ~Descriptor() {
        if (number >= 0) close(number);
    }
};

// Whose fault it is that a path cannot be used: that of the path, or of a machine that has no room, no memory or a
// broken disk.
Fault faultOf(int why) {
    constexpr int kOfPath[] = {ENOENT, ENOTDIR, EISDIR, EACCES, EPERM, EROFS, ELOOP, ENAMETOOLONG, EINVAL, ENXIO};
    return std::ranges::find(kOfPath, why) == std::end(kOfPath) ? Fault::device : Fault::input;
}

std::unexpected<Error> cannotWrite(const std::string& path, int why) {
    return std::unexpected(Error{faultOf(why), path + ": cannot be written: " + std::strerror(why)});
}

// 0, or why not.
int writeAll(int descriptor, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = write(descriptor, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return errno;
        bytes.remove_prefix(static_cast<size_t>(written));
    }
    return 0;
}

// The number behind /dev/stdout, /dev/fd/3 and the like. Opening such a path anew would lose its place in the file.
std::optional<int> openDescriptor(fs::path path) {
    std::error_code failed;
    const fs::path own = fs::path("/proc") / std::to_string(getpid()) / "fd";
    for (int hops = 0; hops < 8; ++hops) {
        if (fs::canonical(path.has_parent_path() ? path.parent_path() : ".", failed) == own && !failed) {
            const std::string name = path.filename();
            int number = 0;
            const auto parsed = std::from_chars(name.data(), name.data() + name.size(), number);
            return parsed.ec == std::errc() ? std::optional(number) : std::nullopt;
        }
        const fs::path next = fs::read_symlink(path, failed);
        if (failed) return std::nullopt;
        path = path.parent_path() / next;
    }
    return std::nullopt;
}

enum class Target { file, through, descriptor };

// What the path is, or why nothing is written there. Makes its folder.
Result<Target> targetOf(const std::string& path) {
    if (path.empty()) return inputError("the name of an output file is empty");
    const fs::path target(path);
    std::error_code failed;
    if (openDescriptor(target)) return Target::descriptor;
    if (target.has_parent_path()) fs::create_directories(target.parent_path(), failed);
    if (failed)
        return std::unexpected(Error{faultOf(failed.value()), path + ": cannot make its folder: " + failed.message()});
    switch (fs::symlink_status(target, failed).type()) {
        case fs::file_type::regular:
        case fs::file_type::not_found:
            return Target::file;
        case fs::file_type::fifo:
        case fs::file_type::character:
            return Target::through;
        case fs::file_type::directory:
            return inputError(path + ": is a folder; name a file");
        case fs::file_type::symlink:
            return inputError(path + ": is a symbolic link; name the file itself");
        default:
            return inputError(path + (failed ? ": " + failed.message() : ": is no regular file"));
    }
}

// A file of its own beside `path`, with the permissions that new files have; nobody knows its name before.
Result<std::pair<Descriptor, std::string>> openBeside(const std::string& path) {
    std::random_device random;
    for (int tries = 0;; ++tries) {
        const std::string name = std::format("{}.{:08x}.part", path, random());
        const int opened = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
        if (opened >= 0) return std::pair(Descriptor(opened), name);
        if (errno != EEXIST || tries == 100) return cannotWrite(path, errno);
    }
}

// What is to replace `path`, in a file beside it until then.
struct Written {
    std::string path, beside;
    Written(std::string path, std::string beside) : path(std::move(path)), beside(std::move(beside)) {}
    Written(Written&& other) noexcept : path(std::move(other.path)), beside(std::exchange(other.beside, "")) {}
    Written& operator=(Written&&) = delete;
    ~Written() {
        if (!beside.empty()) unlink(beside.c_str());
    }
};

Result<void> writeBeside(Written& written, std::string_view bytes) {
    auto opened = openBeside(written.path);
    SKINBENCH_TRY(opened);
    auto& [file, name] = *opened;
    written.beside = name;
    int why = writeAll(file.number, bytes);
    if (close(std::exchange(file.number, -1)) != 0 && why == 0) why = errno;
    return why ? cannotWrite(written.path, why) : Result<void>{};
}

Result<void> putInPlace(Written& written) {
    if (rename(written.beside.c_str(), written.path.c_str()) != 0) return cannotWrite(written.path, errno);
    written.beside.clear();
    return {};
}

Result<void> writeThrough(const std::string& path, std::string_view bytes) {
    const Descriptor file(open(path.c_str(), O_WRONLY | O_NOFOLLOW | O_NOCTTY | O_CLOEXEC));
    const int why = file.number < 0 ? errno : writeAll(file.number, bytes);
    return why ? cannotWrite(path, why) : Result<void>{};
}

// Whether both name one file; a path that does not exist is nothing's equal.
bool isSameFile(const std::string& a, const std::string& b) {
    std::error_code failed;
    return fs::equivalent(a, b, failed) && !failed;
}

}  // namespace

Result<void> writeWholeFile(const std::string& path, std::string_view bytes) {
    auto target = targetOf(path);
    SKINBENCH_TRY(target);
    if (*target == Target::through) return writeThrough(path, bytes);
    if (*target == Target::descriptor) {
        const int why = writeAll(*openDescriptor(path), bytes);
        return why ? cannotWrite(path, why) : Result<void>{};
    }
    Written written{path, ""};
    SKINBENCH_TRY(writeBeside(written, bytes));
    return putInPlace(written);
}

Result<void> writeWholeFiles(const std::vector<std::pair<std::string, std::string>>& files,
                             const std::function<void()>& beforeReplacing) {
    std::vector<Written> written;
    for (const auto& [path, bytes] : files) {
        const auto target = targetOf(path);
        SKINBENCH_TRY(target);
        if (*target != Target::file) return inputError(path + ": is no regular file");
        SKINBENCH_TRY(writeBeside(written.emplace_back(path, ""), bytes));
    }
    if (beforeReplacing) beforeReplacing();
    for (Written& file : written) SKINBENCH_TRY(putInPlace(file));
    return {};
}

Result<void> checkOutput(const std::string& path, std::span<const std::string> inputs) {
    for (const std::string& input : inputs)
        if (isSameFile(path, input)) return inputError(path + ": is an input; name another file to write");
    auto target = targetOf(path);
    SKINBENCH_TRY(target);
    if (*target != Target::file) return {};
    auto opened = openBeside(path);
    SKINBENCH_TRY(opened);
    unlink(opened->second.c_str());
    return {};
}

Result<std::string> readWholeFile(const std::string& path) {
    if (path.empty()) return inputError("the name of an input file is empty");
    const Descriptor file(open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
    struct stat state {};
    if (file.number < 0 || fstat(file.number, &state) != 0)
        return std::unexpected(Error{faultOf(errno), path + ": " + std::strerror(errno)});
    if (S_ISDIR(state.st_mode)) return inputError(path + ": is a folder; name a file");
    if (!S_ISREG(state.st_mode) && !S_ISFIFO(state.st_mode)) return inputError(path + ": is no file");
    if (S_ISREG(state.st_mode) && static_cast<size_t>(state.st_size) > kLargestInput)
        return inputError(path + ": is larger than 1 GiB");
    // One byte more than a regular file has shows its end.
    std::string bytes(S_ISREG(state.st_mode) ? static_cast<size_t>(state.st_size) + 1 : 0, '\0');
    size_t filled = 0;
    for (;;) {
        if (filled == bytes.size()) bytes.resize(std::max(bytes.size() * 2, filled + 65'536));
        pollfd ready{file.number, POLLIN, 0};
        if (S_ISFIFO(state.st_mode) && poll(&ready, 1, kSilence) == 0)
            return inputError(std::format("{}: a pipe that says nothing for {} s", path, kSilence / 1000));
        const ssize_t got = read(file.number, &bytes[filled], bytes.size() - filled);
        if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
        if (got < 0) return std::unexpected(Error{faultOf(errno), path + ": cannot be read: " + std::strerror(errno)});
        if (got == 0) break;
        filled += static_cast<size_t>(got);
        if (filled > kLargestInput) return inputError(path + ": is larger than 1 GiB");
    }
    bytes.resize(filled);
    return bytes;
}

std::string userFile(const char* variable, const char* folder, const std::string& name) {
    const char* given = std::getenv(variable);
    const char* home = std::getenv("HOME");
    if (given && *given == '/') return std::string(given) + "/skinbench/" + name;
    return home && *home ? std::format("{}/{}/skinbench/{}", home, folder, name) : "";
}

}  // namespace skinbench
