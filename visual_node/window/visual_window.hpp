// The node thimble-visual with a window, whose loop is the main thread's work.
#pragma once

#include <memory>
#include <string>

#include "common/runtime/node_program.hpp"
#include "visual_node/page_set.hpp"
#include "visual_node/visual_settings.hpp"
#include "visual_node/window/overlay.hpp"

namespace thimble {

struct VisualWindowOptions {
    bool player = false;       // room for a panel, and the player may close the window
    std::string screenshot{};  // file; empty: none
    // What stands over the scene; its channels are its own, since the node's belong to another thread. Null: nothing.
    std::unique_ptr<Overlay> overlay{};
    PageSet pages{};
};

// Opens the window and the sound. Throws Error (usage) where there is no screen.
std::unique_ptr<NodeInstance> open_visual_window(const VisualSettings& settings, VisualWindowOptions options,
                                                 Sockets& sockets, std::uint64_t instance);

}  // namespace thimble
