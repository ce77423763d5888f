// A controller in Python: a child runs the file, and each call of the table is a record of fixed size to it and its answer back. As
// deterministic as the file is. Slow: some 20 us a call, so for virtual time and lock-step.
#pragma once

#include <filesystem>

#include "common/control/controller.h"

namespace thimble {

// Asks the file for its name and keys. Throws Error (usage) if it cannot be asked.
const thimble_controller* python_controller(const std::filesystem::path& file);

}  // namespace thimble
