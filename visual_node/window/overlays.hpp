// Which overlay belongs to which view.
#pragma once

#include <memory>
#include <string>

#include "common/config.hpp"
#include "common/network_settings.hpp"
#include "visual_node/window/overlay.hpp"

namespace thimble {

enum class View : std::uint8_t {
    kSubject,       // the scene and nothing else
    kPlayer,        // the scene, a pointer that moves the hand, panels
    kExperimenter,  // no scene and no node: what the session tells whoever watches
};
View find_view(const std::string& name);  // "subject", "player", "experimenter"

// Null: the view has none. `network`: for sockets of its own, since the node's belong to another thread.
std::unique_ptr<Overlay> make_overlay(View view, const ConfigFile& file, const NetworkSettings& network,
                                      std::uint64_t instance);

// A window with nothing but this view's overlay, until it is closed, done() or a stop is requested.
void run_watching_view(View view, const ConfigFile& file, const NetworkSettings& network,
                       std::uint64_t instance, bool fullscreen);

}  // namespace thimble
