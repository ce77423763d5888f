// The window of a node thimble-visual: everything that main.cpp would otherwise have to put together.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "common/network_settings.hpp"
#include "visual_node/instructions.hpp"
#include "visual_node/visual_settings.hpp"
#include "visual_node/window/window_display.hpp"
#include "visual_node/window/window_loop.hpp"

namespace thimble {

struct VisualWindowOptions {
    bool player = false;   // room for a panel, and the player may close the window
    bool pointer = false;  // the pointer in the window moves the hand
    bool fullscreen = false;
    std::string screenshot{};  // file; empty: none
    // What stands over the scene; its channels are its own, since the node's belong to another thread. Null: nothing.
    std::unique_ptr<Overlay> overlay{};
    Instructions instructions{};
};

class VisualWindow {
  public:
    // Opens the window and the sound. Throws Error (usage) where there is no screen.
    VisualWindow(const VisualSettings& settings, VisualWindowOptions options, const NetworkSettings& network);

    Display& display() { return display_; }
    // Null unless a pointer in the window moves it.
    HandSource* hand() { return pointer_ ? &hand_ : nullptr; }
    // The main thread's work. Afterwards describe() may be asked.
    WindowEnd run(const std::function<bool()>& stopped) { return loop_.run(stopped); }
    void describe(nlohmann::ordered_json& report) const;

  private:
    bool pointer_;
    GlWindow window_;  // first: without a screen nothing else is worth trying
    WindowDisplay display_;
    PointerHand hand_;
    std::unique_ptr<Beeper> beeper_;
    std::unique_ptr<Overlay> overlay_;
    Instructions instructions_;
    std::optional<Vibration> vibration_;
    WindowLoop loop_;
};

}  // namespace thimble
