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

namespace skinbench::view {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kStep = 1.0 / 60;             // seconds of a stepped frame
constexpr double kSoftwarePixels = 480 * 270;  // of a picture, at the most, where the processor draws it
constexpr auto kSettled = std::chrono::milliseconds(150);

std::unexpected<Error> noWindow() {
    const char* reason = nullptr;
    glfwGetError(&reason);
    return deviceError(std::format("no window can be opened: {}; start it where there is a display with OpenGL 3.3",
                                   reason ? reason : "GLFW"));
}

void onDrop(GLFWwindow* window, int count, const char** paths) {
    dropFiles(*static_cast<Viewer*>(glfwGetWindowUserPointer(window)), {paths, paths + count});
}

// Native contexts are made through GLX or EGL as the platform has it; where X has no GLX, EGL is tried.
GLFWwindow* createWindow(int width, int height) {
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    if (GLFWwindow* window = glfwCreateWindow(width, height, "skinview", nullptr, nullptr)) return window;
    glfwWindowHint(GLFW_CONTEXT_CREATION_API, GLFW_EGL_CONTEXT_API);
    return glfwCreateWindow(width, height, "skinview", nullptr, nullptr);
}

// Fonts are drawn in the display's pixels. On X11 a unit of the window is one of them, elsewhere it may be more.
void setStyle(Viewer& view) {
    ImGuiIO& io = ImGui::GetIO();
    float density = 1, unused = 1;
    glfwGetWindowContentScale(view.window, &density, &unused);
    const auto style = std::tuple(view.state.dark, density, io.DisplayFramebufferScale.x);
    if (std::exchange(view.style, style) == style) return;
    view.density = density;
    view.scale = density / io.DisplayFramebufferScale.x;
    ImGui::GetStyle() = {};
    ImGui::GetStyle().FrameRounding = 3;
    view.state.dark ? ImGui::StyleColorsDark() : ImGui::StyleColorsLight();
    ImGui::GetStyle().Colors[ImGuiCol_WindowBg].w = 1;  // hides the frame before
    ImGui::GetStyle().ScaleAllSizes(view.scale);
    io.MouseDragThreshold = 4 * view.scale;
    io.FontGlobalScale = 1 / io.DisplayFramebufferScale.x;
    ImFontConfig font;
    font.SizePixels = std::floor(13 * density);
    io.Fonts->Clear();
    io.Fonts->AddFontDefault(&font);
    ImGui_ImplOpenGL3_DestroyDeviceObjects();  // the next frame makes them with these fonts
}

ImVec2 toImGui(const glm::vec2& v) { return {v.x, v.y}; }
glm::vec2 toGlm(const ImVec2& v) { return {v.x, v.y}; }
ImTextureID idOf(uint32_t texture) { return reinterpret_cast<ImTextureID>(static_cast<uintptr_t>(texture)); }

// --- layout ----------------------------------------------------------------------------------------------------

bool contains(const Rectangle& place, glm::vec2 at) {
    return glm::all(glm::greaterThanEqual(at, place.at)) && glm::all(glm::lessThan(at, place.at + place.size));
}

bool hasSplitter(const ViewState& state) { return state.mode == Mode::panes || state.mode == Mode::wipe; }

// A picture in the window: it fills `area` as far as its shape allows, and `seen` of it is there.
struct Column {
    size_t picture = 0;  // A, B or the difference
    Rectangle area, seen;
};

std::vector<Column> columnsOf(const Viewer& view) {
    const ViewState& state = view.state;
    const Rectangle& all = view.area;
    if (state.mode == Mode::one) return {{state.shown, all, all}};
    if (state.mode == Mode::difference && view.shown->all.size() > 2) return {{2, all, all}};
    const float left = std::max(1.0f, std::round(all.size.x * state.splitter));
    const Rectangle a{all.at, {left, all.size.y}};
    const Rectangle b{{all.at.x + left, all.at.y}, {std::max(1.0f, all.size.x - left), all.size.y}};
    const bool wipe = state.mode == Mode::wipe;
    return {{0, wipe ? all : a, a}, {1, wipe ? all : b, b}};
}

std::optional<Column> columnAt(const Viewer& view, glm::vec2 at) {
    for (const Column& column : columnsOf(view))
        if (contains(column.seen, at)) return column;
    return std::nullopt;
}

// The largest part of the area that has the picture's shape.
Rectangle fit(const Rectangle& area, const Image& image) {
    const glm::vec2 size(image.width, image.height);
    const glm::vec2 shown = size * std::min(area.size.x / size.x, area.size.y / size.y);
    return {area.at + glm::floor((area.size - shown) * 0.5f), shown};
}

void layOut(Viewer& view) {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float line = ImGui::GetFrameHeight();
    const float beside = view.state.panel ? std::min(360 * view.scale, screen.x * 0.6f) : 0;
    view.area = {{0, line}, {std::max(1.0f, screen.x - beside), std::max(1.0f, screen.y - 2 * line)}};
    glm::dvec2 pixels = glm::dvec2(view.area.size) * static_cast<double>(view.density / view.scale);
    if (view.state.mode == Mode::panes) pixels.x /= 2;
    const bool hardware = std::ranges::any_of(view.thread->backends(), [](const auto& api) {
        return api.second.backend && !api.second.backend->caps().software;
    });
    double resolution = view.state.resolution;
    if (resolution == 0) resolution = hardware ? 1 : std::min(1.0, std::sqrt(kSoftwarePixels / (pixels.x * pixels.y)));
    view.shrunk = view.state.resolution == 0 && resolution < 1;
    const glm::uvec2 wanted(glm::max(pixels * resolution, 1.0));
    if (wanted != view.wanted) view.wantedSince = Clock::now();
    view.wanted = wanted;
    // Each size takes new plans, so pictures follow once the window is left alone.
    if (view.stepped || view.size.x == 0 || Clock::now() - view.wantedSince > kSettled) view.size = wanted;
}

// --- pictures --------------------------------------------------------------------------------------------------

void upload(uint32_t texture, const Image& image) {
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, static_cast<GLsizei>(image.width), static_cast<GLsizei>(image.height), 0,
                 GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
}

// Asks for the pictures of what the window now shows.
void ask(Viewer& view) {
    const std::string wanted = std::format("{} {} {}", settingsText(view.state), view.size.x, view.size.y);
    if (!view.stepped && wanted == view.postedFor && !view.askAccuracy && !view.askPick) return;
    view.postedFor = wanted;
    PictureRequest request = requestOf(view.state, ++view.posted, view.size.x, view.size.y);
    request.accuracy = std::exchange(view.askAccuracy, false);
    request.pick = std::exchange(view.askPick, {});
    view.thread->post(std::move(request));
}

void take(Viewer& view, std::shared_ptr<const Pictures> answer) {
    view.shown = std::move(answer);
    const Pictures& latest = *view.shown;
    view.messages.insert(view.messages.end(), latest.messages.begin(), latest.messages.end());
    if (!view.window) return;
    const auto now = Clock::now();
    const double passed = std::chrono::duration<double>(now - std::exchange(view.answered, now)).count();
    view.period += (std::min(passed, 0.25) - view.period) * 0.1;
    for (size_t i = 0; i < latest.all.size(); ++i)
        if (latest.all[i].image.width) upload(view.textures[i], latest.all[i].image);
    if (latest.error) {
        view.note = latest.error->text;
        const bool asked = view.state.scene == latest.request.scene;
        if (asked && view.state.scene == latest.scene.name) view.state.clip.clear();
        if (asked && !latest.scene.name.empty()) view.state.scene = latest.scene.name;
    }
    remember(view);
}

void drawColumn(const Viewer& view, const Column& column) {
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    const CasePicture& picture = view.shown->all[column.picture];
    const glm::vec2 from = column.seen.at, to = from + column.seen.size, inset = glm::vec2(6, 3) * view.scale;
    const ImU32 color = ImGui::GetColorU32(ImGuiCol_Text);
    list->PushClipRect({from.x, 0}, toImGui(to));
    constexpr std::array kNames = {"A  ", "B  ", ""};
    list->AddText({from.x + inset.x, inset.y}, color, (kNames[column.picture] + picture.title).c_str());
    if (picture.error) {
        list->AddText(nullptr, 0, toImGui(from + 2.0f * inset), color, picture.error->text.c_str(), nullptr,
                      column.seen.size.x - 4 * inset.x);
    } else if (picture.image.width) {
        const Rectangle place = fit(column.area, picture.image);
        list->AddImage(idOf(view.textures[column.picture]), toImGui(place.at), toImGui(place.at + place.size));
    }
    list->PopClipRect();
}

// --- input -----------------------------------------------------------------------------------------------------

// The point of a picture that lies there.
std::optional<Pick> pickAt(const Viewer& view, glm::vec2 at) {
    const auto column = columnAt(view, at);
    if (!column) return std::nullopt;
    const Rectangle place = fit(column->area, view.shown->all[column->picture].image);
    if (!contains(place, at)) return std::nullopt;
    return Pick{column->picture % 2, (at - place.at) / place.size};
}

// What is moved there: over a pane that has an overview, that one, but with Shift the camera, as elsewhere.
std::pair<CameraMove&, const Look&> movedAt(Viewer& view, glm::vec2 at) {
    const auto column = columnAt(view, at);
    if (column && view.state.cases[column->picture % 2].view == View::culled && !ImGui::GetIO().KeyShift)
        return {view.state.overview, view.shown->overview};
    return {view.state.camera, view.shown->look};
}

// The pointer where no panel is: the splitter, cameras, what is picked.
void readPointer(Viewer& view) {
    const ImGuiIO& io = ImGui::GetIO();
    if (!io.MouseDown[0] && !io.MouseReleased[0]) view.splitting = false;
    if (io.WantCaptureMouse) return;
    const Rectangle& area = view.area;
    const glm::vec2 at = toGlm(io.MousePos), by = toGlm(io.MouseDelta) / area.size.y;
    const bool near = std::abs(at.x - area.at.x - area.size.x * view.state.splitter) < 4 * view.scale;
    if (io.MouseClicked[0]) view.splitting = near && hasSplitter(view.state);
    if (view.splitting || (near && hasSplitter(view.state))) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    for (const int button : {0, 1, 2}) {
        if (!ImGui::IsMouseDragging(button)) continue;
        const auto& [move, usual] = movedAt(view, toGlm(io.MouseClickedPos[button]));
        if (button != 0)
            move = gone(move, usual, glm::vec3(-by.x, by.y, 0) * 0.35f);
        else if (!view.splitting)
            move = dragged(move, usual, by, view.state.fly);
        else
            view.state.splitter = std::clamp((at.x - area.at.x) / area.size.x, 0.02f, 0.98f);
    }
    float& zoom = movedAt(view, at).first.zoom;
    if (io.MouseWheel != 0) zoom = std::clamp(zoom * std::pow(0.9f, io.MouseWheel), 0.02f, 50.0f);
    const bool clicked = io.MouseReleased[0] && std::sqrt(io.MouseDragMaxDistanceSqr[0]) < io.MouseDragThreshold;
    if (clicked && !view.splitting) view.askPick = pickAt(view, at);
}

void moveByKeys(Viewer& view) {
    const ImGuiIO& io = ImGui::GetIO();
    const auto towards = [](ImGuiKey ahead, ImGuiKey back) -> int {
        return ImGui::IsKeyDown(ahead) - ImGui::IsKeyDown(back);
    };
    const glm::vec3 by(towards(ImGuiKey_RightArrow, ImGuiKey_LeftArrow), towards(ImGuiKey_PageUp, ImGuiKey_PageDown),
                       towards(ImGuiKey_UpArrow, ImGuiKey_DownArrow));
    const auto& [move, usual] = movedAt(view, toGlm(io.MousePos));
    if (by != glm::vec3(0)) move = gone(move, usual, by * io.DeltaTime * 0.3f);
}

void readKeys(Viewer& view) {
    if (ImGui::GetIO().WantTextInput) return;
    for (int number = ImGuiKey_NamedKey_BEGIN; number < ImGuiKey_NamedKey_END; ++number) {
        const auto key = static_cast<ImGuiKey>(number);
        const std::string_view name = ImGui::GetKeyName(key);
        const bool steps = name == "Period" || name == "Comma";
        if (ImGui::IsKeyPressed(key, steps)) press(view, name, ImGui::GetIO().KeyShift);
    }
    if (view.shown) moveByKeys(view);
}

void drawPictures(Viewer& view) {
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    const Rectangle& area = view.area;
    const glm::vec2 end = area.at + area.size, inset = glm::vec2(6, 3) * view.scale;
    const bool drawn = view.shown && !view.shown->scene.name.empty();
    const char* note = !drawn && view.note.empty() ? "starting the drivers ..." : view.note.c_str();
    list->AddRectFilled({0, 0}, ImGui::GetIO().DisplaySize, ImGui::GetColorU32(ImGuiCol_WindowBg));
    list->AddText({inset.x, end.y + inset.y}, ImGui::GetColorU32(ImGuiCol_Text), note);
    if (!drawn) return;
    readPointer(view);
    for (const Column& column : columnsOf(view)) drawColumn(view, column);
    const float x = area.at.x + area.size.x * view.state.splitter;
    const ImU32 color = ImGui::GetColorU32(view.splitting ? ImGuiCol_SeparatorActive : ImGuiCol_Separator);
    if (hasSplitter(view.state)) list->AddLine({x, 0}, {x, end.y}, color, 2 * view.scale);
}

// Without a window: the pictures alone, each of the size that it would have. The first answer says how long the clip
// is; then the thread always has a frame to begin.
void drawAlone(Viewer& view, Image* image) {
    chooseCases(view.state, view.thread->backends());
    const uint64_t ahead = view.shown ? view.shown->request.number + kFramesInFlight + 1 : 1;
    while (view.posted < ahead) {
        if (view.shown) stepClock(view.state, kStep, view.shown->duration);
        view.thread->post(requestOf(view.state, ++view.posted, view.state.width, view.state.height));
    }
    take(view, view.thread->take());
    if (image) *image = sideBySide({view.shown->all[0].image, view.shown->all[1].image});
}

Image windowImage(GLFWwindow* window) {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window, &width, &height);
    Image image{static_cast<uint32_t>(width), static_cast<uint32_t>(height), {}};
    image.rgba.resize(size_t{image.width} * image.height * 4);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    for (int y = 0; y < height; ++y)  // row 0 is the lowest of OpenGL's
        glReadPixels(0, height - 1 - y, width, 1, GL_RGBA, GL_UNSIGNED_BYTE, &image.rgba[size_t{image.width} * y * 4]);
    for (size_t alpha = 3; alpha < image.rgba.size(); alpha += 4) image.rgba[alpha] = 255;
    return image;
}

}  // namespace

Viewer::~Viewer() {
    thread.reset();
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

Result<std::unique_ptr<Viewer>> openView(const ViewState& state, const PictureOptions& options, bool withWindow) {
    auto view = std::make_unique<Viewer>();
    view->state = state;
    view->stepped = options.every;
    if (!withWindow) {
        view->thread = std::make_unique<PictureThread>(options);
        return view;
    }
    // Looking for Wayland says on standard error that there is none.
    const char* wayland = std::getenv("WAYLAND_DISPLAY");
    if (!wayland || !*wayland) glfwInitHint(GLFW_PLATFORM, GLFW_PLATFORM_X11);
    if (!glfwInit()) return noWindow();
    PictureOptions waking = options;
    waking.answered = glfwPostEmptyEvent;
    // The drivers start beside the window.
    view->thread = std::make_unique<PictureThread>(waking);
    view->window = createWindow(static_cast<int>(state.width), static_cast<int>(state.height));
    if (!view->window) return noWindow();
    glfwSetWindowUserPointer(view->window, view.get());
    glfwSetDropCallback(view->window, onDrop);
    glfwMakeContextCurrent(view->window);
    glfwSwapInterval(view->stepped ? 0 : 1);
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui_ImplGlfw_InitForOpenGL(view->window, true);
    ImGui_ImplOpenGL3_Init("#version 330 core");
    glGenTextures(static_cast<GLsizei>(view->textures.size()), view->textures.data());
    view->last = view->answered = Clock::now();
    return view;
}

bool drawFrame(Viewer& view, Image* image) {
    if (!view.window) {
        drawAlone(view, image);
        return true;
    }
    // Nothing to do until there is input or an answer; tooltips and held keys need a frame now and then.
    if (view.stepped)
        glfwPollEvents();
    else
        glfwWaitEventsTimeout(0.05);
    if (glfwWindowShouldClose(view.window) || view.closing) return false;
    const double passed = std::chrono::duration<double>(Clock::now() - std::exchange(view.last, Clock::now())).count();
    int width = 0, height = 0;
    glfwGetFramebufferSize(view.window, &width, &height);
    // Nobody looks at a window that is minimised: nothing is drawn, and the clock rests.
    if (!view.stepped && (glfwGetWindowAttrib(view.window, GLFW_ICONIFIED) || width == 0 || height == 0)) return true;
    chooseCases(view.state, view.thread->backends());
    ImGui_ImplGlfw_NewFrame();
    setStyle(view);
    ImGui_ImplOpenGL3_NewFrame();
    ImGui::NewFrame();
    readKeys(view);
    layOut(view);
    ask(view);
    for (bool waits = view.stepped; auto answer = view.thread->take(waits); waits = false) take(view, answer);
    drawPictures(view);
    if (view.state.panel) drawPanel(view);
    if (view.state.keys) drawKeys(view);
    ImGui::Render();
    glViewport(0, 0, width, height);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    if (image) *image = windowImage(view.window);
    if (!view.saveTo.empty()) {
        const auto saved = savePng(windowImage(view.window), view.saveTo);
        view.note = saved ? "written: " + view.saveTo : saved.error().text;
        view.saveTo.clear();
    }
    glfwSwapBuffers(view.window);
    if (width > 0 && height > 0) {
        view.state.width = static_cast<uint32_t>(std::lround(static_cast<float>(width) / view.density));
        view.state.height = static_cast<uint32_t>(std::lround(static_cast<float>(height) / view.density));
    }
    const double step = view.stepped ? kStep : std::min(0.25, passed);
    if (view.state.playing && view.shown) stepClock(view.state, step, view.shown->duration);
    return !view.closing;
}

void dropFiles(Viewer& view, const std::vector<std::string>& paths) {
    if (paths.empty()) return;
    view.note = paths.size() > 1 ? std::format("{} files were dropped; the first one is shown", paths.size()) : "";
    view.state.scene = paths.front();
    view.state.clip.clear();
    view.state.seconds = 0;
    view.state.camera = view.state.overview = {};
}

void press(Viewer& view, std::string_view key, bool shift) {
    const Ask wish = pressKey(view.state, view.thread->backends(), key, shift);
    if (wish == Ask::close) view.closing = true;
    if (wish == Ask::accuracy) view.askAccuracy = true;
    if (wish == Ask::screenshot) view.saveTo = std::format("{}skinview-{}.png", view.folder, view.posted);
    if (wish != Ask::command) return;
    ImGui::SetClipboardText(benchCommand(view.state).c_str());
    view.note = "copied: " + benchCommand(view.state);
}

}  // namespace skinbench::view
