// The parts of a view over the scene: text, panels, plots and buttons of Dear ImGui, and their orders to the session.
// Lives in the thread of the window and may take its time; channels it has are its own.
#pragma once

#include <optional>

#include <boost/core/noncopyable.hpp>

#include "common/time.hpp"
#include "visual_node/person_flows.hpp"
#include "visual_node/window/gl_window.hpp"

namespace thimble {

class FrameTimes;  // frame_times.hpp: how long each stage from hand to light took

struct OverlayFrame {
    const GlWindow& window;
    const FrameTimes* times = nullptr;  // null where no scene is drawn
    std::optional<bool> hand_holds{};   // whether a hand here has the needle; nothing where none ever does
    HandKind hand_kind = HandKind::kMouse;
};

class Overlay : boost::noncopyable {
  public:
    virtual ~Overlay() = default;

    // Empties its channels, sends what is due; before each frame and several times in between.
    virtual void tick(SessionTime /*now*/) {}
    // Once per frame, with ImGui ready: calls ImGui:: and nothing of OpenGL.
    virtual void draw(SessionTime now, const OverlayFrame& frame) = 0;
    // How much of the window's right edge the scene leaves to it, pixels.
    virtual double right_margin(const GlWindow& /*window*/) const { return 0; }
    // The window is about to close, because the user asked for it or because its screen is gone.
    virtual void closing(SessionTime /*now*/) {}
};

}  // namespace thimble
