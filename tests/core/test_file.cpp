// Output files are whole or absent; what cannot be read or written is told in one sentence.
#include <filesystem>
#include <fstream>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <thread>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/core/file.h"
#include "tests/scene/gltf_fixture.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;
namespace fs = std::filesystem;

namespace {

fs::path freshFolder(const std::string& name) {
    const fs::path folder = fixture::temporaryFolder() / name;
    fs::remove_all(folder);
    fs::create_directories(folder);
    return folder;
}

size_t filesIn(const fs::path& folder) {
    return static_cast<size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

}  // namespace

TEST_CASE("bytes come back as they were written") {
    const fs::path folder = freshFolder("roundtrip");
    std::string bytes;
    for (int i = 0; i < 70'000; ++i) bytes += static_cast<char>(i * 7 % 256);
    for (const std::string& text : {std::string(), std::string("\0\r\n\0", 4), bytes}) {
        const std::string path = (folder / "file.bin").string();
        REQUIRE(writeWholeFile(path, text));
        const auto read = readWholeFile(path);
        REQUIRE(read);
        CHECK(*read == text);
        CHECK(fs::file_size(path) == text.size());
        CHECK(filesIn(folder) == 1);
    }
}

TEST_CASE("an existing file is replaced, its neighbours stay") {
    const fs::path folder = freshFolder("replace");
    REQUIRE(writeWholeFile((folder / "a").string(), "a long first text"));
    REQUIRE(writeWholeFile((folder / "b").string(), "other"));
    REQUIRE(writeWholeFile((folder / "a").string(), "short"));
    CHECK(*readWholeFile((folder / "a").string()) == "short");
    CHECK(*readWholeFile((folder / "b").string()) == "other");
    CHECK(filesIn(folder) == 2);
}

TEST_CASE("missing folders of the path are made") {
    const fs::path path = freshFolder("deep") / "one" / "two" / "file.txt";
    REQUIRE(writeWholeFile(path.string(), "text"));
    CHECK(*readWholeFile(path.string()) == "text");
}

TEST_CASE("a path that cannot be a file is refused with its name, and nothing is left behind") {
    const fs::path folder = freshFolder("refused");
    REQUIRE(writeWholeFile((folder / "plain").string(), "text"));
    for (const std::string& path : {(folder / "plain" / "below").string(), folder.string(), std::string("/proc/x")}) {
        INFO(path);
        const auto written = writeWholeFile(path, "text");
        REQUIRE(!written);
        CHECK(written.error().text.starts_with(path + ": "));
        CHECK(written.error().text.find('\n') == std::string::npos);
    }
    CHECK(!writeWholeFile("", "text"));
    CHECK(filesIn(folder) == 1);
    CHECK(*readWholeFile((folder / "plain").string()) == "text");
}

TEST_CASE("a write that stops half-way leaves the old file as it was") {
    const fs::path folder = freshFolder("full");
    const std::string path = (folder / "file").string();
    REQUIRE(writeWholeFile(path, "old"));
    rlimit before{};
    REQUIRE(getrlimit(RLIMIT_FSIZE, &before) == 0);
    const rlimit small{4096, before.rlim_max};
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    REQUIRE(setrlimit(RLIMIT_FSIZE, &small) == 0);
    const auto written = writeWholeFile(path, std::string(100'000, 'x'));
    const auto several = writeWholeFiles({{path, "new"}, {(folder / "other").string(), std::string(100'000, 'x')}});
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    for (const auto& stopped : {written, several}) {
        REQUIRE(!stopped);
        CHECK(stopped.error().fault == Fault::device);
        CHECK_THAT(stopped.error().text, ContainsSubstring("cannot be written"));
    }
    CHECK(*readWholeFile(path) == "old");
    CHECK(filesIn(folder) == 1);
}

TEST_CASE("several files replace the old ones together, or none does") {
    const fs::path folder = freshFolder("several");
    const std::string a = (folder / "a").string(), b = (folder / "b").string();
    REQUIRE(writeWholeFiles({{a, "one"}, {b, "two"}}));
    CHECK(*readWholeFile(a) == "one");
    CHECK(*readWholeFile(b) == "two");
    const auto refused = writeWholeFiles({{a, "new"}, {b, "new"}, {(folder / "a" / "below").string(), "new"}});
    REQUIRE(!refused);
    CHECK(refused.error().fault == Fault::input);
    CHECK_FALSE(writeWholeFiles({{a, "new"}, {"/dev/null", "new"}}));
    CHECK(*readWholeFile(a) == "one");
    CHECK(*readWholeFile(b) == "two");
    CHECK(filesIn(folder) == 2);
    std::string before;
    CHECK_FALSE(writeWholeFiles({{a, "new"}, {"/dev/null", "new"}}, [&] { before = "called"; }));
    CHECK(before.empty());
    REQUIRE(writeWholeFiles({{a, "new"}, {b, "new"}}, [&] { before = *readWholeFile(a) + *readWholeFile(b); }));
    CHECK(before == "onetwo");
}

TEST_CASE("what cannot be read is told with its path") {
    const fs::path folder = freshFolder("unreadable");
    const std::string huge = (folder / "huge").string();
    std::ofstream(huge).put('x');
    fs::resize_file(huge, (uintmax_t{1} << 30) + 1);
    const std::vector<std::pair<std::string, const char*>> cases = {{(folder / "missing").string(), "No such file"},
                                                                    {folder.string(), "is a folder"},
                                                                    {huge, "larger than 1 GiB"},
                                                                    {"/dev/zero", ""}};
    for (const auto& [path, why] : cases) {
        INFO(path);
        const auto read = readWholeFile(path);
        REQUIRE(!read);
        CHECK(read.error().text.starts_with(path + ": "));
        CHECK_THAT(read.error().text, ContainsSubstring(why));
    }
    CHECK(readWholeFile("").error().text == "the name of an input file is empty");
}

TEST_CASE("a pipe is read to its end, and written through") {
    const fs::path folder = freshFolder("pipe");
    const std::string fifo = (folder / "fifo").string(), bytes(200'000, 'x');
    REQUIRE(mkfifo(fifo.c_str(), 0600) == 0);
    Result<void> written;
    std::jthread writer([&] { written = writeWholeFile(fifo, bytes); });
    const auto read = readWholeFile(fifo);
    writer.join();
    CHECK(written);
    REQUIRE(read);
    CHECK(*read == bytes);
    CHECK(fs::is_fifo(fifo));
    CHECK(filesIn(folder) == 1);
}

TEST_CASE("a device stays a device, and an open descriptor keeps its place") {
    CHECK(writeWholeFile("/dev/null", "text"));
    CHECK(fs::is_character_file("/dev/null"));
    const auto full = writeWholeFile("/dev/full", "text");
    REQUIRE(!full);
    CHECK_THAT(full.error().text, ContainsSubstring("No space left"));
    CHECK(full.error().fault == Fault::device);
    const std::string path = (freshFolder("descriptor") / "file").string();
    const int file = open(path.c_str(), O_RDWR | O_CREAT, 0600);
    REQUIRE(file >= 0);
    const std::string number = std::to_string(file);
    CHECK(writeWholeFile("/dev/fd/" + number, "first "));
    CHECK(writeWholeFile("/proc/self/fd/" + number, "second"));
    close(file);
    CHECK(*readWholeFile(path) == "first second");
}

TEST_CASE("a symbolic link is neither replaced nor followed") {
    const fs::path folder = freshFolder("link");
    REQUIRE(writeWholeFile((folder / "victim").string(), "old"));
    for (const char* target : {"victim", "nowhere", "."}) {
        const fs::path link = folder / "link";
        fs::remove(link);
        fs::create_symlink(target, link);
        for (const auto& refused : {writeWholeFile(link.string(), "new"), checkOutput(link.string())}) {
            REQUIRE(!refused);
            CHECK_THAT(refused.error().text, ContainsSubstring("is a symbolic link"));
        }
        CHECK(fs::is_symlink(link));
    }
    CHECK(*readWholeFile((folder / "victim").string()) == "old");
    CHECK(!fs::exists(folder / "nowhere"));
}

TEST_CASE("a file of the user lies where the variable says, else below the home") {
    const std::string home = std::getenv("HOME") ? std::getenv("HOME") : "";
    setenv("HOME", "/home/me", 1);
    setenv("SKINBENCH_FOLDER", "/some/where", 1);
    CHECK(userFile("SKINBENCH_FOLDER", ".config", "a.json") == "/some/where/skinbench/a.json");
    for (const char* none : {"", "relative"}) {
        setenv("SKINBENCH_FOLDER", none, 1);
        CHECK(userFile("SKINBENCH_FOLDER", ".config", "a.json") == "/home/me/.config/skinbench/a.json");
    }
    unsetenv("SKINBENCH_FOLDER");
    unsetenv("HOME");
    CHECK(userFile("SKINBENCH_FOLDER", ".config", "a.json").empty());
    setenv("HOME", home.c_str(), 1);
}

TEST_CASE("an output is checked before there is anything to write") {
    const fs::path folder = freshFolder("check");
    const std::string a = (folder / "a").string();
    REQUIRE(writeWholeFile(a, "old"));
    CHECK(checkOutput(a));
    CHECK(checkOutput((folder / "new" / "b").string()));
    CHECK(fs::is_empty(folder / "new"));
    CHECK(*readWholeFile(a) == "old");
    fs::create_hard_link(a, folder / "same");
    for (const std::string& same : {a, (folder / "." / "a").string(), (folder / "same").string()}) {
        const auto refused = checkOutput(same, {&a, 1});
        REQUIRE(!refused);
        CHECK_THAT(refused.error().text, ContainsSubstring("is an input"));
    }
    CHECK(!checkOutput((folder / "a" / "below").string()));
    CHECK(!checkOutput("/proc/x"));
    CHECK(!checkOutput(""));
}

TEST_CASE("two who write one file at once leave one of the two texts") {
    const fs::path folder = freshFolder("both");
    const std::string path = (folder / "file").string(), one(50'000, '1'), two(70'000, '2');
    std::vector<std::jthread> writers;
    for (const std::string* text : {&one, &two})
        writers.emplace_back([&path, text] {
            for (int i = 0; i < 50; ++i)
                if (!writeWholeFile(path, *text)) std::abort();
        });
    writers.clear();
    const auto read = readWholeFile(path);
    REQUIRE(read);
    CHECK((*read == one || *read == two));
    CHECK(filesIn(folder) == 1);
}
