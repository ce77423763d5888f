// The window of a node thimble-visual: everything that main.cpp would otherwise have to put together.
#pragma once

#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "visual_node/visual_settings.hpp"
#include "visual_node/window/overlays.hpp"
#include "visual_node/window/window_display.hpp"
#include "visual_node/window/window_loop.hpp"

namespace thimble {

struct VisualWindowOptions {
    View view = View::kSubject;
    bool fullscreen = false;
    std::string screenshot;  // file; empty: none
};

class VisualWindow {
  public:
    // Opens the window and the sound. Throws Error (usage) where there is no screen.
    VisualWindow(const VisualSettings& settings, const VisualWindowOptions& options, const ConfigFile& file,
                 const NetworkSettings& network, std::uint64_t instance);

    Display& display() { return display_; }
    // Null unless the view is the player's.
    HandSource* hand() { return player_ ? &hand_ : nullptr; }
    // The main thread's work. Afterwards describe() may be asked.
    void run(const std::function<bool()>& stopped) { loop_.run(stopped); }
    void describe(nlohmann::ordered_json& report) const;

  private:
    bool player_;
    WindowDisplay display_;
    PointerHand hand_;
    std::unique_ptr<Beeper> beeper_;
    std::unique_ptr<Overlay> overlay_;
    GlWindow window_;
    WindowLoop loop_;
};

}  // namespace thimble
