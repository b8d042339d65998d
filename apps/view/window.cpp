#include <GLFW/glfw3.h>
#include <imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_opengl3.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <format>
#include <utility>

#include "apps/view/view.h"
#include "common/frame/image.h"

namespace skinbench::view {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kStep = 1.0 / 60;             // seconds of a stepped frame
constexpr double kSoftwarePixels = 480 * 270;  // of a picture, at the most, where the processor draws it
constexpr auto kSettled = std::chrono::milliseconds(150);

std::string glfwFault;

void onGlfwError(int, const char* text) { glfwFault = text; }

void onDrop(GLFWwindow* window, int count, const char** paths) {
    dropFiles(*static_cast<Viewer*>(glfwGetWindowUserPointer(window)), {paths, paths + count});
}

// Native contexts are made through GLX or EGL as the platform has it; where X has no GLX, EGL is tried.
GLFWwindow* createWindow(const ViewState& state) {
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    for (int api : {GLFW_NATIVE_CONTEXT_API, GLFW_EGL_CONTEXT_API}) {
        glfwWindowHint(GLFW_CONTEXT_CREATION_API, api);
        GLFWwindow* window = glfwCreateWindow(static_cast<int>(state.width), static_cast<int>(state.height), "skinview",
                                              nullptr, nullptr);
        if (window) return window;
    }
    return nullptr;
}

void setStyle(const Viewer& view) {
    view.state.dark ? ImGui::StyleColorsDark() : ImGui::StyleColorsLight();
    ImGui::GetStyle().WindowRounding = 0;
    ImGui::GetStyle().FrameRounding = 3;
}

ImVec2 toImGui(const glm::vec2& v) { return {v.x, v.y}; }
ImTextureID idOf(uint32_t texture) { return reinterpret_cast<ImTextureID>(static_cast<uintptr_t>(texture)); }

// --- layout ----------------------------------------------------------------------------------------------------

// How many pixels of a picture a pixel of its pane gets, each way.
double resolutionOf(const Viewer& view, double pixels) {
    if (view.state.resolution > 0) return view.state.resolution;
    const bool hardware = std::ranges::any_of(view.renderer->devices(), [](const auto& api) {
        return api.second.missing.empty() && !api.second.caps.software;
    });
    return hardware ? 1 : std::min(1.0, std::sqrt(kSoftwarePixels / pixels));
}

void layOut(Viewer& view) {
    const ImGuiIO& io = ImGui::GetIO();
    const float line = ImGui::GetFrameHeight();
    const float beside = view.state.panel ? std::min(360 * view.scale, io.DisplaySize.x * 0.6f) : 0;
    view.area = {{0, line}, {std::max(1.0f, io.DisplaySize.x - beside), std::max(1.0f, io.DisplaySize.y - 2 * line)}};
    const Rectangle& area = view.area;
    view.panes = {area, area};
    if (view.state.mode == Mode::panes) {
        view.panes[0].size.x = std::max(1.0f, std::round(area.size.x * view.state.splitter));
        view.panes[1].at.x = area.at.x + view.panes[0].size.x;
        view.panes[1].size.x = std::max(1.0f, area.size.x - view.panes[0].size.x);
    }
    const glm::dvec2 size(view.state.mode == Mode::panes ? area.size.x / 2 : area.size.x, area.size.y);
    const glm::dvec2 pixels = size * glm::dvec2(io.DisplayFramebufferScale.x, io.DisplayFramebufferScale.y);
    const double resolution = resolutionOf(view, pixels.x * pixels.y);
    view.shrunk = view.state.resolution == 0 && resolution < 1;
    const glm::uvec2 wanted(glm::max(pixels * resolution, 1.0));
    if (wanted != view.wanted) view.wantedSince = Clock::now();
    view.wanted = wanted;
    // Each size takes new plans, so pictures follow once the window is left alone.
    if (view.stepped || view.size.x == 0 || Clock::now() - view.wantedSince > kSettled) view.size = wanted;
}

// The largest part of the pane that has the picture's shape.
Rectangle fit(const Rectangle& pane, const Image& image) {
    const glm::vec2 size(image.width, image.height);
    const glm::vec2 shown = size * std::min(pane.size.x / size.x, pane.size.y / size.y);
    return {pane.at + glm::floor((pane.size - shown) * 0.5f), shown};
}

// --- pictures --------------------------------------------------------------------------------------------------

void upload(uint32_t texture, const Image& image) {
    glBindTexture(GL_TEXTURE_2D, texture);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, static_cast<GLsizei>(image.width), static_cast<GLsizei>(image.height), 0,
                 GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
}

// Asks for the pictures of what the window now shows.
void ask(Viewer& view) {
    const std::string wanted = std::format("{} {} {}", settingsText(view.state), view.size.x, view.size.y);
    if (!view.stepped && wanted == view.postedFor && !view.askAccuracy && !view.askPick) return;
    view.postedFor = wanted;
    Request request{++view.posted, view.state, view.size.x, view.size.y, view.askAccuracy, view.askPick};
    view.askAccuracy = false;
    view.askPick.reset();
    view.renderer->post(std::move(request));
}

void take(Viewer& view, std::shared_ptr<const Shown> answer) {
    view.shown = std::move(answer);
    const Shown* latest = view.shown.get();
    const auto now = Clock::now();
    const double passed = std::chrono::duration<double>(now - std::exchange(view.answered, now)).count();
    view.period += (std::min(passed, 0.25) - view.period) * 0.1;
    for (size_t pane = 0; pane < 2; ++pane) {
        if (latest->pictures[pane].error.empty() && latest->pictures[pane].image.width)
            upload(view.textures[pane], latest->pictures[pane].image);
        if (!view.state.cases[pane].route) view.state.cases[pane] = latest->cases[pane];
    }
    if (latest->difference) upload(view.textures[2], latest->difference->image);
    view.messages.insert(view.messages.end(), latest->messages.begin(), latest->messages.end());
    if (!latest->error.empty()) {
        view.note = latest->error;
        if (!latest->scene.empty() && view.state.scene == latest->wanted) view.state.scene = latest->scene;
    }
    remember(view);
}

void takeAll(Viewer& view) {
    if (view.stepped) return take(view, view.renderer->wait());
    while (auto answer = view.renderer->take()) take(view, std::move(answer));
}

void drawPane(const Viewer& view, size_t pane) {
    const Drawn& picture = view.shown->pictures[pane];
    const Rectangle& place = view.panes[pane];
    ImDrawList* list = ImGui::GetWindowDrawList();
    if (!picture.error.empty()) {
        list->AddText(nullptr, 0, toImGui(place.at + glm::vec2(12, 12)), ImGui::GetColorU32(ImGuiCol_Text),
                      picture.error.c_str(), nullptr, place.size.x - 24);
        return;
    }
    if (!picture.image.width) return;
    Rectangle whole = fit(place, picture.image);
    const float split = view.area.at.x + view.area.size.x * view.state.splitter;
    float from = 0, to = 1;
    if (view.state.mode == Mode::wipe) {
        const float cut = std::clamp((split - whole.at.x) / whole.size.x, 0.0f, 1.0f);
        (pane == 0 ? to : from) = cut;
    }
    list->AddImage(idOf(view.textures[pane]), {whole.at.x + whole.size.x * from, whole.at.y},
                   {whole.at.x + whole.size.x * to, whole.at.y + whole.size.y}, {from, 0}, {to, 1});
}

void drawDifference(const Viewer& view) {
    const Shown& shown = *view.shown;
    if (!shown.difference) {
        for (size_t pane = 0; pane < 2; ++pane)
            if (!shown.pictures[pane].error.empty()) return drawPane(view, pane);
        return;
    }
    const Rectangle place = fit(view.area, shown.difference->image);
    ImGui::GetWindowDrawList()->AddImage(idOf(view.textures[2]), toImGui(place.at), toImGui(place.at + place.size));
}

std::string titleOf(const Viewer& view, size_t pane) {
    double total = 0;
    for (const auto& [name, ms] : view.shown->pictures[pane].passes) total += ms;
    return std::format("{}  {:.3f} ms  {}", pane == 0 ? "A" : "B", total, view.shown->pictures[pane].id);
}

void drawTitles(const Viewer& view) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImU32 color = ImGui::GetColorU32(ImGuiCol_Text);
    auto title = [&](const std::string& text, float x, float width) {
        const ImVec4 clip(x, 0, x + width - 4, view.area.at.y);
        list->AddText(nullptr, 0, {x + 6, 3}, color, text.c_str(), nullptr, 0, &clip);
    };
    const ViewState& state = view.state;
    if (state.mode == Mode::difference && view.shown->difference)
        return title(
            std::format("|A - B| x {}: {} of {} pixels differ, by {} of 255 at the most", state.amplify,
                        view.shown->difference->pixels, view.size.x * view.size.y, view.shown->difference->largest),
            0, view.area.size.x);
    if (state.mode == Mode::one) return title(titleOf(view, state.shown), 0, view.area.size.x);
    const float split = view.area.size.x * state.splitter;
    title(titleOf(view, 0), 0, split);
    title(titleOf(view, 1), split, view.area.size.x - split);
}

// --- input -----------------------------------------------------------------------------------------------------

// The point of a picture that lies there.
std::optional<Pick> pickAt(const Viewer& view, glm::vec2 at) {
    const bool second = view.state.mode == Mode::one ? view.state.shown == 1
                        : view.state.mode == Mode::difference
                            ? false
                            : at.x > view.area.at.x + view.area.size.x * view.state.splitter;
    const Drawn& picture = view.shown->pictures[second];
    if (!picture.image.width) return std::nullopt;
    const Rectangle place = fit(view.panes[second], picture.image);
    const glm::vec2 share = (at - place.at) / place.size;
    if (share.x < 0 || share.y < 0 || share.x >= 1 || share.y >= 1) return std::nullopt;
    return Pick{second, share};
}

void moveByMouse(Viewer& view) {
    const ImGuiIO& io = ImGui::GetIO();
    const Look& usual = view.shown->look[0];
    const glm::vec2 moved = glm::vec2(io.MouseDelta.x, io.MouseDelta.y) / view.area.size.y;
    if (ImGui::IsItemActive() && ImGui::IsMouseDragging(ImGuiMouseButton_Left))
        view.state.camera = dragged(view.state.camera, usual, moved, view.state.fly);
    if (ImGui::IsItemActive() && (io.MouseDown[1] || io.MouseDown[2]))
        view.state.camera = gone(view.state.camera, usual, glm::vec3(-moved.x, moved.y, 0) * 0.35f);
    if (ImGui::IsItemHovered() && io.MouseWheel != 0)
        view.state.camera.zoom = std::clamp(view.state.camera.zoom * std::pow(0.9f, io.MouseWheel), 0.02f, 50.0f);
    if (ImGui::IsItemDeactivated() && io.MouseReleased[0] && io.MouseDragMaxDistanceSqr[0] < 16)
        view.askPick = pickAt(view, {io.MousePos.x, io.MousePos.y});
}

void moveByKeys(Viewer& view) {
    const float step = ImGui::GetIO().DeltaTime * 0.3f;
    glm::vec3 move(0);
    if (ImGui::IsKeyDown(ImGuiKey_LeftArrow)) move.x -= step;
    if (ImGui::IsKeyDown(ImGuiKey_RightArrow)) move.x += step;
    if (ImGui::IsKeyDown(ImGuiKey_UpArrow)) move.z += step;
    if (ImGui::IsKeyDown(ImGuiKey_DownArrow)) move.z -= step;
    if (ImGui::IsKeyDown(ImGuiKey_PageUp)) move.y += step;
    if (ImGui::IsKeyDown(ImGuiKey_PageDown)) move.y -= step;
    if (move != glm::vec3(0)) view.state.camera = gone(view.state.camera, view.shown->look[0], move);
}

void obey(Viewer& view, Ask wish) {
    if (wish == Ask::close) view.closing = true;
    if (wish == Ask::accuracy) view.askAccuracy = true;
    if (wish == Ask::screenshot) view.saveTo = std::format("{}skinview-{}.png", view.folder, view.posted);
    if (wish != Ask::command) return;
    ImGui::SetClipboardText(benchCommand(view.state).c_str());
    view.note = "copied: " + benchCommand(view.state);
}

void readKeys(Viewer& view) {
    const ImGuiIO& io = ImGui::GetIO();
    if (io.WantTextInput) return;
    for (int number = ImGuiKey_NamedKey_BEGIN; number < ImGuiKey_NamedKey_END; ++number) {
        const auto key = static_cast<ImGuiKey>(number);
        const std::string_view name = ImGui::GetKeyName(key);
        const bool steps = name == "Period" || name == "Comma";
        if (!ImGui::IsKeyPressed(key, steps)) continue;
        const bool dark = view.state.dark;
        obey(view, pressKey(view.state, view.renderer->devices(), {name, io.KeyShift}));
        if (dark != view.state.dark) setStyle(view);
    }
    if (view.shown) moveByKeys(view);
}

void drawSplitter(Viewer& view) {
    if (view.state.mode != Mode::panes && view.state.mode != Mode::wipe) return;
    const Rectangle& area = view.area;
    const float x = area.at.x + area.size.x * view.state.splitter, half = 4 * view.scale;
    ImGui::SetCursorScreenPos({std::max(0.0f, x - half), area.at.y});
    ImGui::InvisibleButton("splitter", {half * 2, area.size.y});
    const bool held = ImGui::IsItemActive();
    if (held || ImGui::IsItemHovered()) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    if (held) view.state.splitter = std::clamp((ImGui::GetIO().MousePos.x - area.at.x) / area.size.x, 0.02f, 0.98f);
    ImGui::GetWindowDrawList()->AddLine({x, 0}, {x, area.at.y + area.size.y},
                                        ImGui::GetColorU32(held ? ImGuiCol_SeparatorActive : ImGuiCol_Separator), 2);
}

void drawPictures(Viewer& view) {
    constexpr ImGuiWindowFlags kBare = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                       ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus |
                                       ImGuiWindowFlags_NoNav;
    const float line = ImGui::GetFrameHeight();
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize({view.area.size.x, view.area.size.y + 2 * line});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0);
    ImGui::Begin("pictures", nullptr, kBare);
    ImGui::PopStyleVar(3);
    const bool drawn = view.shown && !view.shown->scene.empty();
    if (drawn) {
        if (view.state.mode == Mode::difference)
            drawDifference(view);
        else
            for (size_t pane = 0; pane < 2; ++pane)
                if (view.state.mode != Mode::one || view.state.shown == pane) drawPane(view, pane);
        drawTitles(view);
        ImGui::SetCursorScreenPos(toImGui(view.area.at));
        ImGui::SetNextItemAllowOverlap();
        ImGui::InvisibleButton(
            "scene", toImGui(view.area.size),
            ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight | ImGuiButtonFlags_MouseButtonMiddle);
        moveByMouse(view);
        drawSplitter(view);
    }
    const std::string note = !drawn && view.note.empty() ? "starting the drivers ..." : view.note;
    ImGui::SetCursorScreenPos({6, view.area.at.y + view.area.size.y + 3});
    ImGui::TextUnformatted(note.c_str());
    ImGui::End();
}

Image windowImage(GLFWwindow* window) {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window, &width, &height);
    Image image{static_cast<uint32_t>(width), static_cast<uint32_t>(height), {}};
    const size_t row = size_t{image.width} * 4;
    std::vector<uint8_t> bytes(row * image.height);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, bytes.data());
    for (size_t y = image.height; y-- > 0;) {
        const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(row * y);
        image.rgba.insert(image.rgba.end(), first, first + static_cast<std::ptrdiff_t>(row));
    }
    for (size_t alpha = 3; alpha < image.rgba.size(); alpha += 4) image.rgba[alpha] = 255;
    return image;
}

}  // namespace

Viewer::~Viewer() {
    renderer.reset();
    if (window) {
        glfwMakeContextCurrent(window);
        ImGui_ImplOpenGL3_Shutdown();
        ImGui_ImplGlfw_Shutdown();
        ImGui::DestroyContext();
        glDeleteTextures(static_cast<GLsizei>(textures.size()), textures.data());
        glfwDestroyWindow(window);
    }
    glfwTerminate();
}

Result<std::unique_ptr<Viewer>> openView(const ViewOptions& options) {
    auto view = std::make_unique<Viewer>();
    view->state = options.state;
    view->stepped = options.stepped;
    view->folder = options.folder.empty() ? "" : options.folder + "/";
    glfwSetErrorCallback(onGlfwError);
    // Looking for Wayland says on standard error that there is none.
    const char* wayland = std::getenv("WAYLAND_DISPLAY");
    if (!wayland || !*wayland) glfwInitHint(GLFW_PLATFORM, GLFW_PLATFORM_X11);
    if (!glfwInit())
        return deviceError("no window can be opened: " + glfwFault + "; start it where there is a display");
    RendererOptions renderer = options.renderer;
    renderer.answered = glfwPostEmptyEvent;
    // The drivers start beside the window.
    view->renderer = std::make_unique<Renderer>(renderer);
    view->window = createWindow(options.state);
    if (!view->window) return deviceError("no window with OpenGL 3.3 can be opened: " + glfwFault);
    glfwSetWindowUserPointer(view->window, view.get());
    glfwSetDropCallback(view->window, onDrop);
    glfwMakeContextCurrent(view->window);
    glfwSwapInterval(options.stepped ? 0 : 1);
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui_ImplGlfw_InitForOpenGL(view->window, true);
    ImGui_ImplOpenGL3_Init("#version 330 core");
    float unused = 1;
    glfwGetWindowContentScale(view->window, &view->scale, &unused);
    ImFontConfig font;
    font.SizePixels = std::floor(13 * view->scale);
    ImGui::GetIO().Fonts->AddFontDefault(&font);
    ImGui::GetStyle().ScaleAllSizes(view->scale);
    setStyle(*view);
    glGenTextures(static_cast<GLsizei>(view->textures.size()), view->textures.data());
    for (const uint32_t texture : view->textures) {
        glBindTexture(GL_TEXTURE_2D, texture);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    }
    view->last = view->answered = Clock::now();
    return view;
}

bool drawFrame(Viewer& view, Image* window) {
    // Nothing to do until there is input or an answer; tooltips and held keys need a frame now and then.
    if (view.stepped)
        glfwPollEvents();
    else
        glfwWaitEventsTimeout(0.05);
    if (glfwWindowShouldClose(view.window) || view.closing) return false;
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    readKeys(view);
    layOut(view);
    ask(view);
    takeAll(view);
    drawPictures(view);
    if (view.state.panel) drawPanel(view);
    if (view.state.keys) drawKeys(view);
    ImGui::Render();
    int width = 0, height = 0;
    glfwGetFramebufferSize(view.window, &width, &height);
    glViewport(0, 0, width, height);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    if (window) *window = windowImage(view.window);
    if (!view.saveTo.empty()) {
        const auto saved = savePng(windowImage(view.window), view.saveTo);
        view.note = saved ? "written: " + view.saveTo : saved.error().text;
        view.saveTo.clear();
    }
    glfwSwapBuffers(view.window);
    glfwGetWindowSize(view.window, &width, &height);
    if (width > 0 && height > 0)
        view.state.width = static_cast<uint32_t>(width), view.state.height = static_cast<uint32_t>(height);
    const auto now = Clock::now();
    const double passed = std::min(0.25, std::chrono::duration<double>(now - view.last).count());
    view.last = now;
    if (view.state.playing && view.shown) stepClock(view.state, view.stepped ? kStep : passed, view.shown->duration);
    return !view.closing;
}

void dropFiles(Viewer& view, const std::vector<std::string>& paths) {
    if (paths.empty()) return;
    view.note = paths.size() > 1 ? std::format("{} files were dropped; the first one is shown", paths.size()) : "";
    view.state.scene = paths.front();
    view.state.clip.clear();
    view.state.seconds = 0;
    view.state.camera = {};
}

}  // namespace skinbench::view
