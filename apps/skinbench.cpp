// The program `skinbench`: the words of the command line. What a subcommand does stands in its cmd_*.cpp.
#include <algorithm>
#include <iostream>

#include "apps/command_line.h"
#include "apps/completion.h"
#include "apps/selectors.h"
#include "common/core/version.h"
#include "common/meshlets/partition.h"

namespace skinbench {

namespace {

// "--palette-buffer,--palette": what the help shows first. Every command takes all of them; those that draw pictures
// show the name of the axis.
std::string spellings(const Axis& axis, bool ofPicture = false) {
    std::string name = axis.name;
    std::ranges::replace(name, '_', '-');
    std::vector<std::string> all =
        ofPicture ? std::vector{name, axis.option.name} : std::vector{axis.option.name, name};
    all.insert(all.end(), axis.option.aliases.begin(), axis.option.aliases.end());
    std::string names;
    for (auto word = all.begin(); word != all.end(); ++word)
        if (std::find(all.begin(), word, *word) == word) names += (names.empty() ? "--" : ",--") + *word;
    return names;
}

std::string helpOf(const Axis& axis) { return wordsOf(axis) + axis.option.help; }

std::string usualOf(const Axis& axis) {
    if (axis.name == "vertex_fetch") return "both";
    return axis.inPath && axis.usual.empty() ? "all" : axis.usual;
}

// A single picture.
std::string usualOfPicture(const Axis& axis) {
    if (axis.name == "route") return "auto";
    if (axis.name == "variant") return "what auto takes; on a named route mesh, or vertex where it has no mesh shader";
    if (axis.name == "vertex_fetch") return "attributes, or pull where the codec needs it";
    return usualOf(axis);
}

// Several values are several cases, or pictures.
void addAxes(CLI::App& command, AxisWords& words, bool ofPicture = false) {
    for (const Axis& axis : axes()) {
        if (!axis.benched || (ofPicture && axis.name == "raster")) continue;
        const std::string usual = ofPicture ? usualOfPicture(axis) : usualOf(axis);
        command.add_option(spellings(axis, ofPicture), words[axis.name], helpOf(axis) + " (default: " + usual + ")")
            ->delimiter(',')
            ->allow_extra_args(false)
            ->group("Cases: lists are crossed");
    }
}

void addKeepBackFaces(CLI::App& command, AxisWords& words) {
    command.add_flag_callback(
        "--keep-back-faces", [&words] { words["back_faces"] = {"kept"}; }, "the same as --back-faces kept");
}

constexpr const char* kDeviceHelp = "number, part of the name, UUID or PCI address, as probe shows them";

void addCases(CLI::App& command, std::vector<std::string>& ids) {
    command.add_option("--case", ids, "exactly this case, by its id in a table, a result file or a report")
        ->allow_extra_args(false);
}

void addCharacterPixels(CLI::App& command, Selectors& s) {
    command
        .add_option("--character-pixels", s.characterPixels,
                    "how tall the characters of camera crowd are drawn (default: so that all are in view)")
        ->check(numberFrom(0.1, 100'000.0));
}

void addSelectors(CLI::App& command, Selectors& s) {
    command.add_option("scene", s.scene, "a .gltf or .glb file, or builtin:NAME[:VERTICES]")->capture_default_str();
    addAxes(command, s.words);
    addCases(command, s.caseIds);
    command
        .add_option(
            "--shape", s.shape,
            "given: as --joints, --loads, --records and --palette-buffer say; auto: the fastest of these shapes")
        ->check(oneOf({"given", "auto"}))
        ->capture_default_str();
    command.add_option("--geometry", s.geometry, geometryWords())->capture_default_str();
    command.add_flag("--no-cache-order", s.noCacheOrder, "keep the file's triangle order");
    addKeepBackFaces(command, s.words);
    command.add_option("--clip", s.clip, "name of the animation, or none (default: the first)");
    command.add_option("--pose", s.pose, "frozen or animated")->capture_default_str();
    command.add_option("--camera", s.camera, "crowd, half, inside or close: how many of the copies are in view")
        ->capture_default_str();
    addCharacterPixels(command, s);
    command.add_option("--time", s.seconds, "seconds into the animation at the first frame")
        ->check(numberFrom(0.0, 1e6))
        ->capture_default_str();
    command.add_option("--copies", s.copies, "characters, each with memory of its own (default: by device)")
        ->check(numberFrom(1u, 1'000'000u));
    command.add_option("--frames", s.frames, "timed frames of a case (default: by device; at least one per round)")
        ->check(numberFrom(1u, 100'000u));
    command
        .add_option("--warmup", s.warmup,
                    "untimed frames in every round, repeated until times settle (default: by device)")
        ->check(numberFrom(0u, 10'000u))
        ->each([&s](const std::string&) { s.warmupGiven = true; });
    command.add_option("--rounds", s.rounds, "rounds that share the frames (default: by device)")
        ->check(numberFrom(1u, 1'000u));
    command
        .add_option(
            "--precision", s.precision,
            "percent: rounds go on until half the width of each median's 95 % interval is at most this; 0: only "
            "--rounds (default: 1, or 0 if --frames or --rounds are given)")
        ->check(atLeastZero());
    command
        .add_option("--time-limit", s.timeLimit,
                    "seconds after which --precision begins no more rounds; 0: no limit (default: by device)")
        ->check(atLeastZero());
    command
        .add_option("--placement", s.placement,
                    "kept: cases keep their memory between rounds; fresh: each round prepares them again, so that the "
                    "intervals cover where memory lies (default: kept; fresh with --self-test)")
        ->check(oneOf({"kept", "fresh"}));
    command.add_option("--size", s.size, "WIDTHxHEIGHT of the image")->capture_default_str();
    command.add_option("--preset", s.preset, presetWords() + ": the table below (default: by device)");
    command.add_option("--seed", s.seed, "seed of the order of cases")
        ->check(numberFrom(0u, UINT32_MAX))
        ->capture_default_str();
    command.add_option("--device", s.device, std::string(kDeviceHelp) + ", or all: one after the other");
    command.add_flag("--validation", s.validation,
                     "turn on validation layers and debug output; a message fails its case");
    command.add_option("--tolerance", s.tolerance, "largest relative position error")
        ->check(atLeastZero(true))
        ->capture_default_str();
}

void addProbe(CLI::App& program, int& status) {
    auto options = std::make_shared<ProbeOptions>();
    CLI::App* command =
        program.add_subcommand("probe", "what this machine's devices can run, and why they cannot run the rest");
    command->add_option("--device", options->device, kDeviceHelp);
    command
        ->add_option_function<std::string>(
            "--measure",
            [options](const std::string& scene) {
                if (scene.empty()) throw CLI::ValidationError("--measure", kEmptyValue);
                options->measure = true;
                options->scene = scene;
            },
            "verify and time what auto chooses from, which takes some seconds, on this scene")
        ->expected(0, 1)
        ->default_str(options->scene);
    command->add_flag("--json", options->json, "print JSON");
    command->callback([options, &status] { status = runProbe(*options); });
}

constexpr const char* kTableColumns =
    "Columns of the table:\n"
    "  median ms         time of a frame, all copies together; * on a software driver\n"
    "  ± %               half of the 95 % interval of the median\n"
    "  of vertex, same API\n"
    "                    time over that of the baseline, so 0.5 is twice as fast: the fastest case of the variant\n"
    "                    vertex that draws the same on the same API, or what --baseline names\n"
    "  of its own limit  time over that of the same draws with nothing fetched and nothing skinned. It compares a "
    "case\n"
    "                    with itself, so the slowest case may have the lowest ratio\n"
    "  KiB / copy        device memory of one character\n"
    "  error             largest distance from the double-precision reference, over the bounding box's diagonal\n"
    "Below it: the fastest case and the next one, then the fastest case of each stage, extension and API against those "
    "of\n"
    "the others. The variant none, route cpu and half-rate updates do not compete.\n";

// What verify takes, so that one line of words serves both commands, and has no use for.
constexpr const char* kOptionsOfTimes[] = {"--frames",     "--warmup",    "--rounds", "--precision",
                                           "--time-limit", "--placement", "--seed"};

void addRun(CLI::App& program, int& status, bool timed, const std::string& commandLine) {
    auto options = std::make_shared<RunOptions>();
    options->timed = timed;
    options->command = commandLine;
    options->out = timed ? "results" : "";
    CLI::App* command = timed ? program.add_subcommand("bench", "verify and time every selected case")
                              : program.add_subcommand("verify", "check every selected case against the CPU reference");
    addSelectors(*command, options->selectors);
    command->add_option("--out", options->out, "folder of results.json, results.csv and report.html")
        ->capture_default_str();
    command->add_flag("--json", options->json, "print the result file instead of a table");
    command->add_flag("--list", options->list, "print the cases that would run, and why others would not");
    if (timed)
        command
            ->add_option("--baseline", options->baseline,
                         "what times are divided by: a variant, on the same API, or the id of a case")
            ->default_str(kUsualBaseline);
    else
        for (const char* name : kOptionsOfTimes) command->get_option(name)->group("");
    command->footer("Presets, and the default for each kind of device:\n" + presetTable() + "\n" + kTableColumns);
    if (timed)
        command->add_flag("--self-test", options->selectors.selfTest,
                          "time every case twice under two names and report how far equal ones differ");
    command->callback([options, &status] { status = runCases(*options); });
}

void addRender(CLI::App& program, int& status) {
    auto options = std::make_shared<RenderOptions>();
    CLI::App* command =
        program.add_subcommand("render", "draw one variant to a PNG file, or several side by side: --method lbs,dqs");
    Selectors& s = options->selectors;
    command->add_option("scene", s.scene, "a .gltf or .glb file, or builtin:NAME[:VERTICES]")->required();
    addAxes(*command, s.words, true);
    addKeepBackFaces(*command, s.words);
    command
        ->add_option(
            "--case", s.caseIds,
            "exactly this case, by its id in a table, a result file or a report; again for each further picture")
        ->allow_extra_args(false);
    command->add_flag("--difference", options->difference,
                      "with two pictures: also their difference, amplified 16 times");
    command
        ->add_option("--animate", options->animate,
                     "draw this many frames of the clip, into a folder of PNG files or a .webp file")
        ->check(numberFrom(1u, kMostFrames));
    command->add_option("--view", options->view, wordsOf(*findAxis("view")) + " (default: shaded)");
    command->add_option("--time", s.seconds, "seconds into the animation")
        ->check(numberFrom(0.0, 1e6))
        ->capture_default_str();
    command->add_option("--clip", s.clip, "name of the animation, or none (default: the first)");
    command->add_option("--size", s.size, "WIDTHxHEIGHT")->capture_default_str();
    command->add_option("--camera", s.camera, "crowd, half, inside or close")->capture_default_str();
    addCharacterPixels(*command, s);
    command->add_option("--copies", s.copies, "number of characters (default: 1)")->check(numberFrom(1u, 1'000'000u));
    command->add_option("--yaw", options->yaw, "degrees that a single character is turned by")
        ->check(numberFrom(-360.0f, 360.0f))
        ->capture_default_str();
    command->add_option("--device", s.device, kDeviceHelp);
    command->add_flag("--validation", s.validation, "turn on validation layers and debug output");
    command->add_option("-o,--output", options->out, "the PNG file; with --animate a folder, or a .webp file")
        ->required();
    command->callback([options, &status] { status = runRender(*options); });
}

constexpr const char* kInspectColumns =
    "Columns of the tables:\n"
    "  vertices, triangles  of a meshlet, on average; v fill, t fill: the share of its limits that they are\n"
    "  reuse                how many meshlets a vertex is in, on average\n"
    "  tuples               different sets of joints of a meshlet's vertices, on average\n"
    "  joints, most         different joints of a meshlet, on average and at the most\n"
    "  common               meshlets whose vertices share one list of joints\n"
    "  records              vertices that are stored then, with copies\n"
    "  remainder            triangles in the other meshlets\n"
    "  blend                bytes a vertex for joints and weights, with copied vertices\n"
    "docs/codecs.md says what the codecs, buffers and errors are.\n";

void addInspect(CLI::App& program, int& status) {
    auto options = std::make_shared<InspectOptions>();
    CLI::App* command = program.add_subcommand("inspect", "a scene's meshlets, codec errors and buffer sizes");
    Selectors& s = options->selectors;
    command->add_option("scene", s.scene, "a .gltf or .glb file, or builtin:NAME[:VERTICES]")->required();
    command
        ->add_option(spellings(*findAxis("meshlet_limits")), s.words["meshlet_limits"],
                     "limits of a meshlet, as VERTICES/TRIANGLES (default: 64/124)")
        ->expected(1);
    command->add_option("--influences", s.words["influences"], "4 or 8 (default: 4)")->expected(1);
    command->add_option("--ci-key", s.words["ci_key"], wordsOf(*findAxis("ci_key")) + " (default: ordered, fit)")
        ->delimiter(',')
        ->allow_extra_args(false);
    command->add_option("--ci-min", s.words["ci_min"], findAxis("ci_min")->option.help)->expected(1);
    command->add_flag("--all", options->all,
                      "also unwelded and in the file's order (default: only as drawn, welded and in cache order)");
    command->add_flag("--json", options->json, "print JSON");
    command->footer(kInspectColumns);
    command->callback([options, &status] { status = runInspect(*options); });
}

void addScene(CLI::App& program, int& status) {
    struct Options {
        bool json = false;
        std::string name, out;
    };
    auto options = std::make_shared<Options>();
    CLI::App* command = program.add_subcommand("scene", "built-in scenes");
    command->require_subcommand(1);
    CLI::App* list = command->add_subcommand("list", "the built-in scenes");
    list->add_flag("--json", options->json, "print JSON");
    list->callback([options, &status] { status = runSceneList(options->json); });
    CLI::App* save = command->add_subcommand("export", "write a scene as a GLB file");
    save->add_option("name", options->name, "NAME, builtin:NAME[:VERTICES] or a glTF file")->required();
    save->add_option("out", options->out, "the .glb file")->required();
    save->callback([options, &status] { status = runSceneExport(options->name, options->out); });
}

void addPartition(CLI::App& program, int& status) {
    auto options = std::make_shared<PartitionOptions>();
    CLI::App* command = program.add_subcommand("partition", "draw lists for hardware with few palette slots");
    command->add_option("scene", options->scene, "a .gltf or .glb file, or builtin:NAME[:VERTICES]")->required();
    command->add_option("--hardware", options->hardware, tableNames(paletteHardware()))->capture_default_str();
    command->add_option("--slots", options->slots, "joints that one draw can use, with --hardware generic")
        ->default_str(std::to_string(findPaletteHardware("generic")->slots))
        ->check(numberFrom(1u, 65'535u));
    command->add_option("--solver", options->solver, tableNames(partitionSolvers()))->capture_default_str();
    command->add_option("--order", options->order, "order of the groups: " + tableNames(groupOrders()))
        ->capture_default_str();
    command->add_option("--influences", options->influences, "4 or 8")->check(oneOf({"4", "8"}))->capture_default_str();
    command->add_flag("--json", options->json, "print JSON with the command list");
    command->callback([options, &status] { status = runPartition(*options); });
}

void addReport(CLI::App& program, int& status) {
    struct Options {
        std::vector<std::string> files;
        std::string out = "report.html";
    };
    auto options = std::make_shared<Options>();
    CLI::App* command = program.add_subcommand("report", "one HTML page from one or more result files");
    command->add_option("files", options->files, "results.json files, or folders with one")->required();
    command->add_option("-o,--output", options->out, "the page")->capture_default_str();
    command->callback([options, &status] { status = runReport(options->files, options->out); });
}

void addCompare(CLI::App& program, int& status) {
    auto options = std::make_shared<CompareOptions>();
    CLI::App* command = program.add_subcommand("compare", "which cases differ between two result files, beyond noise");
    command->add_option("A", options->a, "the results.json to compare with, or a folder with one")->required();
    command->add_option("B", options->b,
                        "the one that is compared; with --pair it may be left out, to compare cases of A");
    command
        ->add_option("--pair", options->pair,
                     "AXIS or AXIS=VALUE: compares cases that differ only in these axes (codec, variant, route, …), "
                     "from VALUE (default: the usual one) to every other")
        ->delimiter(',')
        ->allow_extra_args(false);
    command
        ->add_option(
            "--fail-above", options->failAbove,
            "exit with 1 if the whole interval of a case is more than this many percent above A and beyond the "
            "noise floor, or if a case of A is missing, failed or not timed in B")
        ->check(atLeastZero());
    command->add_flag("--allow-missing", options->allowMissing, "with --fail-above: B may lack cases of A");
    command->add_flag("--json", options->json, "print JSON");
    command->callback([options, &status] { status = runCompare(*options); });
}

void addReproduce(CLI::App& program, int& status) {
    auto options = std::make_shared<ReproduceOptions>();
    CLI::App* command =
        program.add_subcommand("reproduce", "the tables and figures of a thesis, published beside ours");
    Selectors& s = options->selectors;
    command->add_option("thesis", options->thesis, "torabi or kimmersdorfer")->required();
    command->add_option("scenes", options->scenes,
                        "glTF files or builtin:NAME[:VERTICES] (default: every built-in scene)");
    command
        ->add_option(spellings(*findAxis("route")), s.words["route"], wordsOf(*findAxis("route")) + " (default: all)")
        ->delimiter(',')
        ->allow_extra_args(false);
    command->add_option("--copies", s.copies, "characters, each with memory of its own (default: by device)")
        ->check(numberFrom(1u, 1'000'000u));
    command->add_option("--frames", s.frames, "timed frames of a case (default: by device)")
        ->check(numberFrom(1u, 100'000u));
    command->add_option("--rounds", s.rounds, "rounds that share the frames (default: by device)")
        ->check(numberFrom(1u, 1'000u));
    command->add_option("--size", s.size, "WIDTHxHEIGHT of the image")->capture_default_str();
    command->add_option("--device", s.device, kDeviceHelp);
    command->add_option("--out", options->out, "folder of reproduce.md, reproduce.html and reproduce.json")
        ->capture_default_str();
    command->add_flag("--json", options->json, "print reproduce.json instead of the short table");
    command->callback([options, &status] { status = runReproduce(*options); });
}

void addCompletion(CLI::App& program, int& status) {
    auto shell = std::make_shared<std::string>();
    CLI::App* command = program.add_subcommand("completion", "print the completion script for bash, zsh or fish");
    command->add_option("shell", *shell, "bash, zsh or fish")->required();
    command->callback([shell, &program, &status] {
        const auto script = completionScript(program, *shell);
        if (script) std::cout << *script;
        status = script ? kExitDone : reportError(script.error());
    });
}

// The program by its name alone.
std::string commandLine(int argc, char** argv) {
    std::string text = "skinbench";
    for (int i = 1; i < argc; ++i) text += " " + shellWord(argv[i]);
    return text;
}

constexpr const char* kFooter =
    "EXIT STATUS\n"
    "    0 done, 1 something you asked for failed or was interrupted before any case was done, or the disk is full,\n"
    "    2 bad arguments or input. One line on standard error says what is wrong.\n"
    "\n"
    "FILES\n"
    "    results/            results.json, results.csv and report.html of the last bench\n"
    "    ~/.cache/skinbench  pipelines that Vulkan has compiled\n"
    "\n"
    "ENVIRONMENT\n"
    "    CUDA_VISIBLE_DEVICES, GPU_DEVICE_ORDINAL, SLURM_STEP_GPUS, SLURM_JOB_GPUS\n"
    "        limit the devices that may be used; probe shows which are left\n"
    "\n"
    "EXAMPLES\n"
    "    skinbench bench hero.glb --copies 100\n"
    "        verifies and times every variant on every route with your own character\n"
    "    skinbench bench --routes vk,gl-nv --variants vertex,mesh\n"
    "        only some of them\n"
    "    skinbench render hero.glb --view weights -o weights.png\n"
    "        a picture\n"
    "    skinbench completion bash > ~/.local/share/bash-completion/completions/skinbench\n"
    "        installs completion for bash\n"
    "\n"
    "SEE ALSO\n"
    "    skinbench COMMAND --help, skinview --help";

int runProgram(int argc, char** argv) {
    CLI::App program{"Compares skinning on this machine's GPUs: vertex, compute and mesh shaders, Vulkan and OpenGL.",
                     "skinbench"};
    program.set_version_flag("--version", std::string(SKINBENCH_VERSION) + " (" + SKINBENCH_REVISION + ")",
                             "the version");
    writeManual(program);
    program.require_subcommand(1);
    int status = kExitDone;
    addProbe(program, status);
    addRun(program, status, true, commandLine(argc, argv));
    addRun(program, status, false, commandLine(argc, argv));
    addRender(program, status);
    addInspect(program, status);
    addScene(program, status);
    addPartition(program, status);
    addReport(program, status);
    addReproduce(program, status);
    addCompare(program, status);
    addCompletion(program, status);
    program.footer(kFooter);
    if (const auto ended = parseWords(program, argc, argv)) return *ended;
    return status == kExitDone ? flushOutput() : status;
}

}  // namespace
}  // namespace skinbench

int main(int argc, char** argv) { return skinbench::guarded(skinbench::runProgram, argc, argv); }
