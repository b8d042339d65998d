// Which device a run takes, over invented machines.
#include <format>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/frame/devices.h"
#include "tests/cases.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;

namespace {

const std::vector<Api> kBoth = {Api::vulkan, Api::opengl};

DeviceCaps gpu(Api api, const std::string& name, const std::string& uuid = "", const std::string& pci = "",
               uint32_t vendor = kVendorNvidia) {
    DeviceCaps caps = generousCaps(api);
    caps.name = name;
    caps.uuid = uuid;
    caps.pci = pci;
    caps.vendor = vendor;
    return caps;
}

DeviceCaps software(Api api, const std::string& uuid = "6d657361-3235-2e30-2e37-000000000000") {
    DeviceCaps caps = gpu(api, "llvmpipe (LLVM 19.1.7, 256 bits)", uuid, "", 0);
    caps.software = true;
    return caps;
}

std::string uuidOf(char digit) {
    const std::string d(1, digit);
    return std::format(
        "{0}{0}{0}{0}{0}{0}{0}{0}-{0}{0}{0}{0}-{0}{0}{0}{0}-{0}{0}{0}{0}-{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}"
        "{0}{0}",
        d);
}

std::string pciOf(int bus) { return pciText(0, static_cast<uint32_t>(bus), 0, 0); }

// `count` H200, with lavapipe behind them; OpenGL lists the cards backwards and knows only their UUIDs.
Machine node(int count, const Environment& environment = {}) {
    ApiDevices vulkan{Api::vulkan, {}}, opengl{Api::opengl, {}};
    for (int i = 0; i < count; ++i) {
        vulkan.devices.push_back(
            gpu(Api::vulkan, "NVIDIA H200", uuidOf(static_cast<char>('a' + i % 6)), pciOf(0x10 * (count - i))));
        opengl.devices.insert(opengl.devices.begin(),
                              gpu(Api::opengl, "NVIDIA H200", uuidOf(static_cast<char>('a' + i % 6))));
    }
    vulkan.devices.push_back(software(Api::vulkan));
    opengl.devices.push_back(software(Api::opengl));
    return makeMachine({vulkan, opengl}, environment);
}

size_t picked(const Machine& machine, const std::string& word) {
    const auto device = pickDevice(machine, word, kBoth);
    INFO(word << ": " << (device ? "" : device.error().text));
    REQUIRE(device);
    return *device;
}

std::string refusal(const Machine& machine, const std::string& word) {
    const auto device = pickDevice(machine, word, kBoth);
    INFO(word);
    REQUIRE(!device);
    CHECK(device.error().fault == Fault::device);
    CHECK(device.error().text.size() < 400);
    return device.error().text;
}

size_t entry(const Machine& machine, size_t device, Api api) {
    const auto found = entryOf(machine, device, api);
    INFO((found ? found->note : found.error().text));
    REQUIRE(found);
    CHECK(found->note == "");
    return found->number;
}

}  // namespace

TEST_CASE("UUIDs and PCI addresses have one spelling") {
    CHECK(uuidText({}) == "");
    CHECK(uuidText({0x1a, 0x2b, 0x3c, 0x4d, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 255}) ==
          "1a2b3c4d-0001-0203-0405-060708090aff");
    for (const char* address : {"0000:3b:00.0", "3B:00.0", "00000000:3B:00.0", "0:3b:0.0"})
        CHECK(pciText(address) == "0000:3b:00.0");
    CHECK(pciText(0x10000, 0xff, 31, 7) == "10000:ff:1f.7");
    CHECK(pciText("10000:ff:1f.7") == "10000:ff:1f.7");
    for (const char* word : {"", "3b", "3b:00", "3b:00.", ":.", "0:0:0:0.0", "3b:00.8", "100:00.0", "3b:20.0",
                             "3b:00.0x", "000000000:3b:00.0", "NVIDIA H200", "-1:00.0"}) {
        CAPTURE(word);
        CHECK(pciText(word) == "");
    }
}

TEST_CASE("both APIs take the card of one UUID, in whatever order they list it") {
    const Machine machine = node(3);
    REQUIRE(machine.devices.size() == 4);
    for (size_t i = 0; i < 3; ++i) {
        CHECK(entry(machine, i, Api::vulkan) == i);
        CHECK(entry(machine, i, Api::opengl) == 2 - i);
    }
    const DeviceCaps caps = capsOf(machine, 1, machine.apis[1].devices[1]);
    CHECK(caps.pci == "0000:20:00.0");
    CHECK(caps.number == 1);
    CHECK(caps.label == "NVIDIA H200 (0000:20:00.0)");
    CHECK(machine.devices[3].label == "llvmpipe (LLVM 19.1.7, 256 bits)");
    CHECK(machine.notes.empty());
}

TEST_CASE("cards without UUIDs are matched by their PCI address, then by a name that is the only one") {
    const Machine byPci = makeMachine(
        {{Api::vulkan, {gpu(Api::vulkan, "A (RADV)", "", pciOf(1)), gpu(Api::vulkan, "A (RADV)", "", pciOf(2))}},
         {Api::opengl, {gpu(Api::opengl, "A (si)", "", pciOf(2)), gpu(Api::opengl, "A (si)", "", pciOf(1))}}},
        {});
    CHECK(byPci.devices.size() == 2);
    CHECK(entry(byPci, 0, Api::opengl) == 1);
    // Two vendors' drivers may count UUIDs differently.
    const Machine otherUuid = makeMachine({{Api::vulkan, {gpu(Api::vulkan, "A", uuidOf('a'), pciOf(1))}},
                                           {Api::opengl, {gpu(Api::opengl, "B", uuidOf('b'), pciOf(1))}}},
                                          {});
    CHECK(otherUuid.devices.size() == 1);
    const Machine byName =
        makeMachine({{Api::vulkan, {gpu(Api::vulkan, "A (RADV)"), gpu(Api::vulkan, "B (RADV)")}},
                     {Api::opengl, {gpu(Api::opengl, "B (si)"), gpu(Api::opengl, "A (si)"), software(Api::opengl)}}},
                    {});
    CHECK(byName.devices.size() == 3);
    CHECK(entry(byName, 1, Api::opengl) == 0);
}

TEST_CASE("UUIDs that two devices of an API share count as none") {
    const std::string shared = uuidOf('0');
    const Machine machine = makeMachine({{Api::vulkan, {gpu(Api::vulkan, "A", shared), gpu(Api::vulkan, "B", shared)}},
                                         {Api::opengl, {gpu(Api::opengl, "B", shared)}}},
                                        {});
    REQUIRE(machine.devices.size() == 2);
    CHECK(machine.devices[0].uuid == "");
    CHECK(entry(machine, 1, Api::opengl) == 0);
    CHECK(entryOf(machine, 0, Api::opengl).error().text == "OpenGL does not offer A, only 1 (B)");
}

TEST_CASE("two drivers for one card stay two devices with its address") {
    const Machine machine = makeMachine(
        {{Api::vulkan, {gpu(Api::vulkan, "A (RADV)", "", pciOf(1)), gpu(Api::vulkan, "A PRO", "", pciOf(1))}},
         {Api::opengl, {gpu(Api::opengl, "A (si)", "", pciOf(1))}}},
        {});
    REQUIRE(machine.devices.size() == 2);
    CHECK(entry(machine, 0, Api::opengl) == 0);
    CHECK(machine.devices[1].pci == pciOf(1));
    CHECK_THAT(refusal(machine, "1:00.0"), ContainsSubstring("'1:00.0' fits 2 devices"));
}

TEST_CASE("where nothing tells two cards of one name apart, the run says so") {
    const Machine machine =
        makeMachine({{Api::vulkan, {gpu(Api::vulkan, "H", uuidOf('a')), gpu(Api::vulkan, "H", uuidOf('b'))}},
                     {Api::opengl, {gpu(Api::opengl, "H"), gpu(Api::opengl, "H"), software(Api::opengl)}}},
                    {});
    REQUIRE(machine.devices.size() == 5);
    CHECK(picked(machine, "") == 0);
    const auto guess = entryOf(machine, 1, Api::opengl);
    REQUIRE(guess);
    CHECK(guess->number == 1);
    CHECK(
        guess->note ==
        "whether OpenGL's H is the same device as H (device 1) cannot be told: no UUID or PCI address that both give");
    CHECK(entryOf(machine, 2, Api::vulkan)->number == 0);
    CHECK(allDevices(machine) == std::vector<size_t>{0, 1});
    CHECK(entryOf(machine, 4, Api::vulkan).error().text ==
          "Vulkan does not offer llvmpipe (LLVM 19.1.7, 256 bits), only 0 (H (device 0)), 1 (H (device 1))");
}

TEST_CASE("without a name the device is hardware that every API has") {
    CHECK(picked(node(2), "") == 0);
    CHECK(picked(node(0), "") == 0);
    const Machine onlySecond = makeMachine(
        {{Api::vulkan, {software(Api::vulkan), gpu(Api::vulkan, "A", uuidOf('a')), gpu(Api::vulkan, "B", uuidOf('b'))}},
         {Api::opengl, {software(Api::opengl), gpu(Api::opengl, "B", uuidOf('b'))}}},
        {});
    CHECK(picked(onlySecond, "") == 2);
    CHECK(pickDevice(onlySecond, "", {Api::vulkan}) == 2u);  // the same one, whatever runs
    // A card that OpenGL does not know is not replaced by a software driver there.
    const Machine noEgl = makeMachine({{Api::vulkan, {gpu(Api::vulkan, "A", uuidOf('a')), software(Api::vulkan)}},
                                       {Api::opengl, {software(Api::opengl)}}},
                                      {});
    CHECK(picked(noEgl, "") == 0);
    CHECK_THAT(entryOf(noEgl, 0, Api::opengl).error().text, ContainsSubstring("OpenGL does not offer A"));
    const Machine none = makeMachine({{Api::vulkan, {}, "Vulkan: no loader"}, {Api::opengl, {}, "OpenGL: no EGL"}}, {});
    CHECK(refusal(none, "") == "Vulkan: no loader; OpenGL: no EGL");
    CHECK(refusal(none, "0") == "Vulkan: no loader; OpenGL: no EGL");
}

TEST_CASE("a device is named by number, part of the name, UUID or PCI address") {
    const Machine machine = node(2);
    CHECK(picked(machine, "0") == 0);
    CHECK(picked(machine, "1") == 1);
    CHECK(picked(machine, "2") == 2);
    CHECK(picked(machine, "LLVM") == 2);
    CHECK(picked(machine, uuidOf('b')) == 1);
    CHECK(picked(machine, "GPU-" + uuidOf('B')) == 1);
    CHECK(picked(machine, "GPU-bb") == 1);
    CHECK(picked(machine, "bbbbbbbb") == 1);
    CHECK(picked(machine, "10:00.0") == 1);
    CHECK(picked(machine, "00000000:20:00.0") == 0);
    CHECK_THAT(refusal(machine, "bbbbbbb"), ContainsSubstring("no device 'bbbbbbb'; there is 0 (NVIDIA H200, UUID "));
    CHECK_THAT(refusal(machine, "30:00.0"), ContainsSubstring("no device '30:00.0'"));
    CHECK_THAT(refusal(machine, "GPU-c"), ContainsSubstring("no device 'GPU-c'"));
    CHECK_THAT(refusal(machine, "MIG-" + uuidOf('a')), ContainsSubstring("MIG"));
    CHECK_THAT(refusal(machine, "voodoo"), ContainsSubstring("PCI 0000:10:00.0"));
    const Machine whole = makeMachine({{Api::vulkan, {gpu(Api::vulkan, "RTX"), gpu(Api::vulkan, "RTX 2")}}}, {});
    CHECK(picked(whole, "rtx") == 0);
}

TEST_CASE("a word of digits is a number and never a part of a name") {
    const Machine machine = node(2);
    CHECK_THAT(refusal(machine, "200"), ContainsSubstring("no device '200'"));
    CHECK_THAT(refusal(machine, "3"), ContainsSubstring("no device '3'"));
    CHECK_THAT(refusal(machine, "99999999999999999999"), ContainsSubstring("no device '9"));
    CHECK_THAT(refusal(machine, "H200"), ContainsSubstring("fits 2 devices"));
}

TEST_CASE("a name that fits several devices lists them") {
    CHECK(refusal(node(2), "nvidia") ==
          "'nvidia' fits 2 devices, so name one by its number, UUID or PCI address: 0 (NVIDIA H200, UUID " +
              uuidOf('a') + ", PCI 0000:20:00.0), 1 (NVIDIA H200, UUID " + uuidOf('b') + ", PCI 0000:10:00.0)");
    const std::string eight = refusal(node(6), "nvidia");
    for (int i = 1; i < 7; ++i) CHECK_THAT(eight, ContainsSubstring(pciOf(0x10 * i)));
}

TEST_CASE("CUDA_VISIBLE_DEVICES is followed as CUDA follows it") {
    struct Row {
        std::string value;
        std::vector<size_t> visible;  // numbers of node(3): PCI addresses run backwards; 3 is the software driver
    };
    const Row rows[] = {
        {"0", {2, 3}},
        {"2", {0, 3}},
        {"2,1", {0, 1, 3}},
        {" 1 , 0 ", {1, 2, 3}},
        {"0,0", {2, 3}},
        {"0,-1,1", {2, 3}},
        {"0,7,1", {2, 3}},
        {"", {3}},
        {"-1", {3}},
        {"NoDevFiles", {3}},
        {"0x1", {3}},
        {"GPU-" + uuidOf('b'), {1, 3}},
        {"GPU-b,GPU-A", {1, 0, 3}},
        {"GPU-d,GPU-a", {3}},
        {"GPU-", {3}},
    };
    for (const Row& row : rows) {
        CAPTURE(row.value);
        const Machine machine = node(3, {{"CUDA_VISIBLE_DEVICES", row.value}, {"SLURM_JOB_GPUS", "1"}});
        CHECK(machine.order == row.visible);
        CHECK(picked(machine, "") == row.visible.front());
        REQUIRE(machine.notes.size() == (row.visible.size() < 4 ? 1 : 0));
        CHECK_THAT(machine.notes[0], ContainsSubstring("CUDA_VISIBLE_DEVICES=" + row.value + " hides "));
    }
    const Machine same = node(2, {{"CUDA_VISIBLE_DEVICES", "0,1"}});
    CHECK(same.notes.empty());
    CHECK(same.order == std::vector<size_t>{1, 0, 2});
}

TEST_CASE("a hidden device cannot be named, and makes a name clear") {
    const Machine machine = node(2, {{"CUDA_VISIBLE_DEVICES", "1"}});
    CHECK_THAT(refusal(machine, "1"), ContainsSubstring("is hidden by CUDA_VISIBLE_DEVICES=1"));
    CHECK_THAT(refusal(machine, pciOf(0x10)), ContainsSubstring("is hidden by CUDA_VISIBLE_DEVICES=1"));
    CHECK(picked(machine, "h200") == 0);
    CHECK(picked(machine, "llvmpipe") == 2);
    CHECK(allDevices(machine) == std::vector<size_t>{0});
    CHECK(allDevices(node(3)) == std::vector<size_t>{0, 1, 2});
    CHECK(allDevices(node(2, {{"CUDA_VISIBLE_DEVICES", ""}})) == std::vector<size_t>{2});
    Machine bare = makeMachine({{Api::vulkan, {gpu(Api::vulkan, "A")}}}, {{"CUDA_VISIBLE_DEVICES", "-1"}});
    CHECK(refusal(bare, "") == "every device is hidden by CUDA_VISIBLE_DEVICES=-1");
}

TEST_CASE("CUDA_VISIBLE_DEVICES says nothing of other vendors' devices") {
    const std::vector<ApiDevices> apis = {{Api::vulkan,
                                           {gpu(Api::vulkan, "AMD", "", pciOf(1), kVendorAmd),
                                            gpu(Api::vulkan, "A", "", pciOf(3)), gpu(Api::vulkan, "B", "", pciOf(2))}}};
    CHECK(makeMachine(apis, {{"CUDA_VISIBLE_DEVICES", "0"}}).order == std::vector<size_t>{2, 0});
    CHECK(makeMachine(apis, {{"SLURM_JOB_GPUS", "0"}}).order == std::vector<size_t>{2, 0});
    const Machine amd = makeMachine({{Api::vulkan, {apis[0].devices[0]}}}, {{"CUDA_VISIBLE_DEVICES", "-1"}});
    CHECK(amd.order == std::vector<size_t>{0});
    CHECK(amd.notes.empty());
}

TEST_CASE("MIG instances cannot be matched, which one line says") {
    const Machine machine = node(2, {{"CUDA_VISIBLE_DEVICES", "MIG-" + uuidOf('a')}});
    REQUIRE(machine.notes.size() == 1);
    CHECK_THAT(machine.notes[0], ContainsSubstring("MIG instance"));
    CHECK(machine.order == std::vector<size_t>{0, 1, 2});
}

TEST_CASE("a scheduler's assignment is followed") {
    CHECK(node(3, {{"SLURM_STEP_GPUS", "1"}, {"SLURM_JOB_GPUS", "0,1,2"}}).order == std::vector<size_t>{1, 3});
    CHECK(node(3, {{"SLURM_JOB_GPUS", "2,0"}}).order == std::vector<size_t>{0, 2, 3});
    CHECK(node(3, {{"GPU_DEVICE_ORDINAL", "0"}, {"SLURM_JOB_GPUS", "2"}}).order == std::vector<size_t>{2, 3});
    // Number 5 of the node, and the task sees only its own.
    CHECK(node(1, {{"SLURM_JOB_GPUS", "5"}}).order == std::vector<size_t>{0, 1});
    const Machine lost = node(3, {{"SLURM_JOB_GPUS", "7"}});
    CHECK(lost.order == std::vector<size_t>{0, 1, 2, 3});
    REQUIRE(lost.notes.size() == 1);
    CHECK_THAT(lost.notes[0], ContainsSubstring("SLURM_JOB_GPUS=7 fits no device here"));
}

TEST_CASE("numbers without PCI addresses are said to be unsure") {
    const Machine machine =
        makeMachine({{Api::vulkan, {gpu(Api::vulkan, "A"), gpu(Api::vulkan, "B")}}}, {{"CUDA_VISIBLE_DEVICES", "1"}});
    CHECK(machine.order == std::vector<size_t>{1});
    REQUIRE(machine.notes.size() == 2);
    CHECK_THAT(machine.notes[1], ContainsSubstring("not every device has a PCI address"));
}

TEST_CASE("folders of devices are short and plain") {
    CHECK(deviceFolder(node(1), 0) == "0-nvidia-h200");
    CHECK(deviceFolder(node(1), 1) == "1-llvmpipe");
    const Machine odd =
        makeMachine({{Api::vulkan, {gpu(Api::vulkan, std::format("../\xff / {}", std::string(99, 'X')))}}}, {});
    CHECK(deviceFolder(odd, 0) == std::format("0-{}", std::string(30, 'x')));
}

TEST_CASE("refusals are said once each, the farthest first, in so many characters") {
    const std::vector<Refusal> refusals = {{"EGL device 0", 0, "eglInitialize said EGL_NOT_INITIALIZED"},
                                           {"EGL device 1", 2, "no core profile of version 4.5 or newer"},
                                           {"the default display", 0, "eglInitialize said EGL_NOT_INITIALIZED"}};
    CHECK(
        refusalText(refusals, 400) ==
        "no core profile of version 4.5 or newer (EGL device 1); eglInitialize said EGL_NOT_INITIALIZED (EGL device 0, "
        "the default display)");
    CHECK(refusalText(refusals, 80) == "no core profile of version 4.5 or newer (EGL device 1); 1 more");
    CHECK(refusalText({}, 80) == "");
    CHECK(refusalText({{"here", 0, std::string(900, 'x')}}, 100).size() <= 100);
}
