// Dear ImGui in a GlWindow: context, backends, a font and a style in the window's content scale. ImGui knows one context
// per program, so there is one GuiLayer at a time. Made after the window, gone before it.
#pragma once

#include <string>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "visual_node/window/gl_window.hpp"

struct ImFont;

namespace thimble {

class GuiLayer : boost::noncopyable {
  public:
    // `text`: what will be drawn beyond Latin-1, as far as the font has it.
    explicit GuiLayer(GlWindow& window, std::string text = {});
    ~GuiLayer();

    // Between GlWindow::begin_frame() and end_frame(): everything of ImGui:: is called between these two.
    void begin();
    void end();

    // ImGui has the mouse, or a text field takes the key: the event is not meant for the scene. Releases of keys are for both.
    bool wants(const WindowEvent& event) const;
    // Of pages, twice the size of ImGui's own text.
    ImFont* large_font() const { return large_; }

    // A key went down or up. One that does both between two frames is seen as down by the next frame.
    void hear_key(int key, bool down);

  private:
    void fit_to_scale();

    GlWindow* window_;
    std::vector<int> went_down_, up_after_frame_;  // keys of GLFW, since the last frame
    std::string text_;
    ImFont* large_ = nullptr;
    double scale_ = 0;  // that fonts and style were made for
};

// The characters of a text (UTF-8) that would be drawn as boxes, each once: "U+1F600, U+4E2D"; empty if there are none.
std::string undrawable(const std::string& text);
// Throws Error (usage) that names them: a subject is not to read boxes.
void check_drawable(const std::string& instructions);

}  // namespace thimble
