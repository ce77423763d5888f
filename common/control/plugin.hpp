// Loads the user's own controller (controller.h): a shared library, or a Python file, which a child runs.
#pragma once

#include <filesystem>

#include "common/control/control_settings.hpp"
#include "common/control/controller.h"

namespace thimble {

// With the values that its keys have by default. Throws Error (usage) that names the file and what is wrong with it.
PluginSettings load_plugin(const std::filesystem::path& file);

// A table that breaks the interface's rules: why; empty: none found.
std::string wrong_table(const thimble_controller& table);

// Of the force, for the hand; 1 if the plug-in gives no number within 0 to 1.
double plugin_hand_share(const PluginSettings& plugin);

}  // namespace thimble
