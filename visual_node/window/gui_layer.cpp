#include "visual_node/window/gui_layer.hpp"

#include <algorithm>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <cstring>
#include <epoxy/gl.h>
#include <imgui.h>
#include <set>
#include <stb_truetype.h>
#include <string_view>
#include <utility>
#include <vector>
// clang-format off
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
// clang-format on

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "common/text_file.hpp"
#include "visual_node/instructions.hpp"

namespace thimble {
namespace {

constexpr float kText_px = 16;  // at content scale 1
constexpr float kLargeText_px = 32;
// Debian's fonts-dejavu-core. Without it ImGui's own font, of 13 pixels and thus coarse when enlarged.
constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";

ImVector<ImWchar> ranges_of(ImFontAtlas& atlas, const std::string& text) {
    ImFontGlyphRangesBuilder builder;
    builder.AddRanges(atlas.GetGlyphRangesDefault());
    builder.AddText(text.c_str());
    ImVector<ImWchar> ranges;
    builder.BuildRanges(&ranges);
    return ranges;
}

// ImGui's own reader of files ends the program if it cannot read one.
ImFont* add_font(ImFontAtlas& atlas, float size_px, const ImVector<ImWchar>& ranges) {
    try {
        const std::string font = read_whole_file(kFont);
        void* owned = IM_ALLOC(font.size());  // the atlas frees it
        std::memcpy(owned, font.data(), font.size());
        return atlas.AddFontFromMemoryTTF(owned, static_cast<int>(font.size()), size_px, nullptr,
                                          ranges.Data);
    } catch (const Error&) {
        ImFontConfig own;
        own.SizePixels = size_px;
        return atlas.AddFontDefault(&own);
    }
}

// ImGui's own reader makes U+FFFD of what is too large for its characters.
std::set<unsigned> characters_of(const std::string& text) {
    std::set<unsigned> characters;
    for (std::string_view rest = text; !rest.empty();) characters.insert(take_character(rest));
    return characters;
}

// The characters that add_font() finds. It draws no glyph for the answer: Debian's stb_truetype asserts where no memory is left.
class FontCharacters {
  public:
    FontCharacters() {
        try {
            file_ = read_whole_file(kFont);
        } catch (const Error&) {
            return;
        }
        const auto* bytes = reinterpret_cast<const unsigned char*>(file_.data());
        known_ = stbtt_InitFont(&font_, bytes, stbtt_GetFontOffsetForIndex(bytes, 0)) != 0;
    }
    bool has(unsigned character) const {
        if (!known_) return character >= 0x20 && character <= 0xFF;  // ImGui's own font
        return character <= IM_UNICODE_CODEPOINT_MAX &&
               stbtt_FindGlyphIndex(&font_, static_cast<int>(character)) != 0;
    }

  private:
    std::string file_;
    stbtt_fontinfo font_{};
    bool known_ = false;
};

// ImGui's own listener also calls that of the window.
void hear(GLFWwindow* window, int key, int scancode, int action, int modifiers) {
    ImGui_ImplGlfw_KeyCallback(window, key, scancode, action, modifiers);
    auto* const layer = static_cast<GuiLayer*>(ImGui::GetIO().UserData);
    if (action != GLFW_REPEAT) layer->hear_key(key, action == GLFW_PRESS);
}

}  // namespace

GuiLayer::GuiLayer(GlWindow& window, std::string text) : window_(&window), text_(std::move(text)) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;  // a session leaves no files behind that it does not name
    ImGui_ImplGlfw_InitForOpenGL(window.handle(), true);
    ImGui::GetIO().UserData = this;
    glfwSetKeyCallback(window.handle(), hear);
    ImGui_ImplOpenGL3_Init(epoxy_is_desktop_gl() ? "#version 330 core" : "#version 300 es");
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
        ImGui_ImplOpenGL3_CreateFontsTexture();  // NewFrame makes only the first one
    }
    if (!window_->lost()) {
        ImGui_ImplOpenGL3_NewFrame();
        ImGui_ImplGlfw_NewFrame();
    }
    // A screen that has just gone has no size, and ImGui insists on one.
    if (window_->lost()) ImGui::GetIO().DisplaySize = {1, 1};
    ImGui::NewFrame();
    for (const int key : up_after_frame_) ImGui::GetIO().KeysDown[key] = false;
    went_down_.clear();
    up_after_frame_.clear();
}

void GuiLayer::hear_key(int key, bool down) {
    if (key < 0) return;  // one that GLFW does not know
    if (down) {
        went_down_.push_back(key);
    } else if (std::find(went_down_.begin(), went_down_.end(), key) != went_down_.end()) {
        ImGui::GetIO().KeysDown[key] = true;
        up_after_frame_.push_back(key);
    }
}

void GuiLayer::end() {
    ImGui::Render();
    if (!window_->lost()) ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

bool GuiLayer::wants(const WindowEvent& event) const {
    const ImGuiIO& io = ImGui::GetIO();
    switch (event.kind) {
        case WindowEvent::Kind::kKey:
            // ImGui wants all keys while the mouse holds an item, but only a text field has a use for them.
            return event.pressed && io.WantTextInput;
        case WindowEvent::Kind::kMotion:
        case WindowEvent::Kind::kButton:
            return io.WantCaptureMouse && !window_->pointer_grabbed();
        default:
            return false;
    }
}

void GuiLayer::fit_to_scale() {
    scale_ = window_->content_scale();
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    atlas.Clear();
    const auto scale = static_cast<float>(scale_);
    const ImVector<ImWchar> ranges = ranges_of(atlas, text_);  // the atlas points to them until it is built
    add_font(atlas, kText_px * scale, ranges);
    large_ = add_font(atlas, kLargeText_px * scale, ranges);
    atlas.Build();
    ImGui::GetStyle() = ImGuiStyle{};
    ImGui::StyleColorsDark();
    ImGui::GetStyle().ScaleAllSizes(scale);
}

std::string undrawable(const std::string& text) {
    const FontCharacters font;
    std::vector<std::string> missing;
    for (const unsigned character : characters_of(text))
        if (character != '\n' && !font.has(character)) missing.push_back(fmt::format("U+{:04X}", character));
    return fmt::format("{}", fmt::join(missing, ", "));
}

void check_drawable(const std::string& instructions) {
    const std::string missing = undrawable(instructions);
    if (missing.empty()) return;
    throw Error(ExitCode::kUsage,
                "the window's font has no characters for these in [instructions]: {}. Use others", missing);
}

}  // namespace thimble
