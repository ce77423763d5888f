// Dear ImGui in a GlWindow: context, backends, a font and a style in the window's content scale. ImGui knows one context
// per program, so there is one GuiLayer at a time. Made after the window, gone before it.
#pragma once

#include <string>

#include "visual_node/window/gl_window.hpp"

struct ImFont;

namespace thimble {

class GuiLayer {
  public:
    // `text`: what will be drawn beyond Latin-1, as far as the font has it.
    explicit GuiLayer(GlWindow& window, std::string text = {});
    ~GuiLayer();
    GuiLayer(const GuiLayer&) = delete;
    GuiLayer& operator=(const GuiLayer&) = delete;

    // Between GlWindow::begin_frame() and end_frame(): everything of ImGui:: is called between these two.
    void begin();
    void end();

    // ImGui has the mouse or the keyboard: the event is not meant for the scene.
    bool wants(const WindowEvent& event) const;
    // Of pages, twice the size of ImGui's own text.
    ImFont* large_font() const { return large_; }

  private:
    void fit_to_scale();

    GlWindow* window_;
    std::string text_;
    ImFont* large_ = nullptr;
    double scale_ = 0;  // that fonts and style were made for
};

}  // namespace thimble
