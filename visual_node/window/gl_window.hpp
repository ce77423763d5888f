// A GLFW window with an OpenGL 3.3 core context. One thread, the program's main thread, makes it, polls it and draws
// in it. Lengths are framebuffer pixels, y downwards, unless a name says otherwise.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include <boost/core/noncopyable.hpp>

#include "common/time.hpp"
#include "visual_node/window/image.hpp"

struct GLFWwindow;
namespace thimble {

struct WindowSettings {
    std::string title = "Thimble";
    int width = 800;  // at content scale 1; a monitor that scales text makes the window larger as well
    int height = 600;
    bool visible = true;
    bool fullscreen = false;   // on the primary monitor, in its own resolution
    bool vsync = true;         // end_frame() waits for the monitor
    double content_scale = 0;  // instead of the monitor's; 0: as the monitor says
    bool embedded = false;     // OpenGL ES 3 instead of OpenGL 3.3, as in WebGL 2
    // Text and panels have scale 1 in a window of this size, and grow with the window. 0: the monitor's scale.
    int scale_from_width = 0, scale_from_height = 0;
};

// The user's actions at the window. Only the fields of its kind are set.
struct WindowEvent {
    enum class Kind : std::uint8_t {
        kKey,  // key, pressed, repeated
        kMotion,  // x, y: the pointer; while it is grabbed, way since the last event (raw counts where there are such)
        kButton,  // any; pressed, x, y: the pointer
        kResize,  // x, y: new size of the framebuffer
        kFocus,   // pressed: it has the keyboard now
    };
    Kind kind = Kind::kKey;
    bool pressed = false;
    bool repeated = false;
    int key = 0;  // GLFW_KEY_...
    double x = 0;
    double y = 0;
    SessionTime time{};  // when the program took it from the window system
};

class GlWindow : boost::noncopyable {
  public:
    // Throws Error (usage) where there is no screen, or none with OpenGL 3.3: what is missing and what to do.
    explicit GlWindow(const WindowSettings& settings);
    ~GlWindow();

    // Takes what the window system has; the events are valid until the next call. More than kMaxEvents between two
    // calls: the rest is lost.
    std::span<const WindowEvent> poll_events();
    // The same, but sleeps until there is an event, at most `longest`.
    std::span<const WindowEvent> wait_events(Duration longest);
    static constexpr std::size_t kMaxEvents = 1024;

    // Makes the context current and clears the whole framebuffer.
    void begin_frame(const Rgb& ground);
    // Shows what was drawn: swaps, waiting for the monitor with vsync.
    void end_frame();

    // The user asked to close it, or the screen is gone.
    bool should_close() const;
    // As a click on the close button does.
    void ask_to_close();
    // Ignores a request to close the window.
    void stay_open();
    // The connection to the screen broke: nothing can be drawn any more. Every call is then harmless and does nothing.
    bool lost() const;

    int width() const;  // of the framebuffer
    int height() const;
    // How much larger than on a plain 96 dpi monitor text and lines have to be.
    double content_scale() const;
    double refresh_Hz() const;  // of the monitor; 60 where it does not say

    // Hides the pointer and keeps it in the window: motion is then relative, and raw where the system offers that.
    void grab_pointer(bool grabbed);
    bool pointer_grabbed() const;

    // The picture that is drawn and not shown yet: call it before end_frame().
    Image read_pixels() const;
    // For ImGui's backend, which may put its own callbacks in front: they chain to this window's.
    GLFWwindow* handle() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace thimble
