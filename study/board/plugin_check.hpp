// thimble board --check FILE: does a plug-in keep the rules of common/control/controller.h? Each probe runs in a copy of the process, so
// that one that crashes or hangs is a finding as well.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/time.hpp"

namespace thimble {

struct PluginFinding {
    std::string rule;  // "asks for no memory, clock or file after create", ...
    bool kept = false;
    std::string words;  // how it was seen; with a rule that is kept, how it was tried
};

struct PluginCheck {
    std::string file, name;  // of the plug-in; its name is empty where it cannot be loaded
    std::vector<PluginFinding> findings;

    bool good() const;
    int exit_code() const { return good() ? 0 : 1; }
    std::string text() const;  // a line for each rule
    std::string json() const;
};

// With the values that its keys have by default, then replaced by `values` as far as they go. A probe with a call that takes longer
// than `limit` is the last. It throws nothing for a bad plug-in.
PluginCheck check_plugin(const std::filesystem::path& file, const std::vector<double>& values = {},
                         Duration limit = std::chrono::seconds{5});

}  // namespace thimble
