#include "viewer/window/ui.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <array>
#include <filesystem>

namespace pagoda::viewer {
namespace {

constexpr double kTextPx = 15.0;

// Where distributions put a sans-serif font that everyone has; without any, ImGui's own.
constexpr std::array kFonts = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                               "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
                               "/usr/share/fonts/TTF/DejaVuSans.ttf",
                               "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
                               "/usr/share/fonts/liberation-sans/LiberationSans-Regular.ttf"};

void loadFont(float sizePx) {
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    // Letters, and the few signs that our texts use.
    static constexpr std::array<ImWchar, 7> kRanges = {0x20, 0xFF, 0x2013, 0x2026, 0x3C4, 0x3C4, 0};
    for (const char* path : kFonts) {
        std::error_code ignored;
        if (!std::filesystem::exists(path, ignored)) continue;
        if (atlas.AddFontFromFileTTF(path, sizePx, nullptr, kRanges.data()) != nullptr) return;
    }
    ImFontConfig config;
    config.SizePixels = sizePx;
    atlas.AddFontDefault(&config);
}

void setStyle(float scale) {
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 6.0f;
    style.FrameRounding = style.GrabRounding = style.PopupRounding = 4.0f;
    style.WindowBorderSize = 0.0f;
    style.WindowPadding = {12.0f, 10.0f};
    style.FramePadding = {8.0f, 4.0f};
    style.ItemSpacing = {8.0f, 5.0f};
    style.WindowMinSize = {16.0f, 16.0f};
    style.CellPadding = {6.0f, 2.0f};
    const ImVec4 accent(0.30f, 0.56f, 0.72f, 1.0f), accentDark(0.22f, 0.40f, 0.52f, 1.0f);
    ImVec4* const colours = style.Colors;
    colours[ImGuiCol_WindowBg] = {0.085f, 0.10f, 0.115f, 0.86f};
    colours[ImGuiCol_PopupBg] = {0.085f, 0.10f, 0.115f, 0.97f};
    colours[ImGuiCol_Text] = {0.93f, 0.94f, 0.95f, 1.0f};
    colours[ImGuiCol_TextDisabled] = {0.62f, 0.66f, 0.70f, 1.0f};
    colours[ImGuiCol_FrameBg] = {0.20f, 0.23f, 0.26f, 1.0f};
    colours[ImGuiCol_FrameBgHovered] = {0.26f, 0.30f, 0.34f, 1.0f};
    colours[ImGuiCol_FrameBgActive] = {0.30f, 0.35f, 0.40f, 1.0f};
    colours[ImGuiCol_CheckMark] = colours[ImGuiCol_SliderGrab] = accent;
    colours[ImGuiCol_SliderGrabActive] = {0.45f, 0.70f, 0.85f, 1.0f};
    colours[ImGuiCol_Button] = colours[ImGuiCol_Header] = accentDark;
    colours[ImGuiCol_ButtonHovered] = colours[ImGuiCol_HeaderHovered] = accent;
    colours[ImGuiCol_ButtonActive] = colours[ImGuiCol_HeaderActive] = accent;
    colours[ImGuiCol_Separator] = {1.0f, 1.0f, 1.0f, 0.12f};
    style.ScaleAllSizes(scale);
}

}  // namespace

Ui::Ui(GlfwWindow& window) {
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;  // panels lie where we put them
    io.LogFilename = nullptr;
    // Where a window's units are pixels (X11), text grows by itself; where they are not, ImGui
    // scales what it draws, and text is drawn at the finer size and shrunk.
    glm::ivec2 size(0);
    glfwGetWindowSize(window.handle(), &size.x, &size.y);
    const double pixelsPerUnit =
        size.x > 0 ? static_cast<double>(window.framebufferPx().x) / size.x : 1.0;
    const auto textScale = static_cast<float>(window.contentScale());
    textScale_ = textScale / static_cast<float>(pixelsPerUnit);
    setStyle(textScale_);
    loadFont(static_cast<float>(kTextPx) * textScale);
    io.FontGlobalScale = 1.0f / static_cast<float>(pixelsPerUnit);
    ImGui_ImplGlfw_InitForOpenGL(window.handle(), false);
    ImGui_ImplOpenGL3_Init("#version 450 core");
}

Ui::~Ui() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

void Ui::beginFrame() {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    beganS_ = glfwGetTime();
    ImGui::NewFrame();
}

void Ui::endFrame() {
    ImGui::Render();
    const double builtS = glfwGetTime();
    buildMs_ = 1e3 * (builtS - beganS_);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    drawMs_ = 1e3 * (glfwGetTime() - builtS);
}

bool Ui::wantsMouse() const {
    return ImGui::GetIO().WantCaptureMouse;
}

bool Ui::wantsKeys() const {
    return ImGui::GetIO().WantTextInput;
}

void numberRow(const char* name, const std::string& value) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextDisabled("%s", name);
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(value.c_str());
}

std::string lengthText(double modelUnits) {
    return fmt::format("{:.4g}", modelUnits);
}

}  // namespace pagoda::viewer
