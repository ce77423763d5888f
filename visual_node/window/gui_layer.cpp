#include "visual_node/window/gui_layer.hpp"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>
#include <utility>

#include "visual_node/window/fonts.hpp"

namespace thimble {

GuiLayer::GuiLayer(GlWindow& window, std::string text) : window_(&window), text_(std::move(text)) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;  // a session leaves no files behind that it does not name
    ImGui_ImplGlfw_InitForOpenGL(window.handle(), true);
    ImGui_ImplOpenGL3_Init("#version 330 core");
    fit_to_scale();
}

GuiLayer::~GuiLayer() {
    if (!window_->lost()) {  // the backends would ask the screen that is gone
        ImGui_ImplOpenGL3_Shutdown();
        ImGui_ImplGlfw_Shutdown();
    }
    ImGui::GetIO().BackendPlatformUserData = nullptr;
    ImGui::GetIO().BackendRendererUserData = nullptr;
    ImGui::DestroyContext();
}

void GuiLayer::begin() {
    if (window_->content_scale() != scale_ && !window_->lost()) {
        ImGui_ImplOpenGL3_DestroyFontsTexture();
        fit_to_scale();
    }
    if (!window_->lost()) {
        ImGui_ImplOpenGL3_NewFrame();
        ImGui_ImplGlfw_NewFrame();
    }
    // A screen that has just gone has no size, and ImGui insists on one.
    if (window_->lost()) ImGui::GetIO().DisplaySize = {1, 1};
    ImGui::NewFrame();
}

void GuiLayer::end() {
    ImGui::Render();
    if (!window_->lost()) ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

bool GuiLayer::wants(const WindowEvent& event) const {
    const ImGuiIO& io = ImGui::GetIO();
    switch (event.kind) {
        case WindowEvent::Kind::kKey:
            return io.WantCaptureKeyboard;
        case WindowEvent::Kind::kMotion:
        case WindowEvent::Kind::kButton:
        case WindowEvent::Kind::kScroll:
            return io.WantCaptureMouse && !window_->pointer_grabbed();
        default:
            return false;
    }
}

void GuiLayer::fit_to_scale() {
    scale_ = window_->content_scale();
    ImGui::GetIO().Fonts->Clear();
    large_ = build_fonts(*ImGui::GetIO().Fonts, scale_, text_).large;
    ImGui::GetStyle() = ImGuiStyle{};
    ImGui::StyleColorsDark();
    ImGui::GetStyle().ScaleAllSizes(static_cast<float>(scale_));
}

}  // namespace thimble
