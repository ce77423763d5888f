// Keys of a session file, drawn from what its readers describe. So a key that a reader gains is drawn without a line here.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/config.hpp"
#include "common/random.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {

struct DrawnKey {
    std::string path;   // as KeyDeclaration has it
    std::string value;  // as a file would write it
};
using DrawnKeys = std::vector<DrawnKey>;

// The keys of a session that virtual time knows. `plugin`: a controller that some sessions have; empty: none has.
std::vector<KeyDeclaration> drawable_keys(const std::filesystem::path& plugin = {});

// A session: short, with up to nine keys that differ from their defaults at random, and keys of codec and controller in some.
DrawnKeys draw_keys(const std::vector<KeyDeclaration>& keys, RandomStream& draw);

// As a session file.
std::string keys_text(const DrawnKeys& keys);

// The settings that these keys are. Removes the keys that a reader refuses beside the others; throws std::logic_error if a reader
// refuses the file and names none of its keys.
SystemSettings settings_of(DrawnKeys& keys);

}  // namespace thimble
