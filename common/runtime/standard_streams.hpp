// The three standard descriptors: none of them stays closed, and a slow reader of stderr never blocks the program.
#pragma once

#include <string>
#include <string_view>

#include "common/time.hpp"

namespace thimble {

// Opens /dev/null in the place of each one that is closed, or the next file would take its number. Comes first in every program.
void open_standard_descriptors();

// A separate thread writes these words to stderr, so that a held terminal (Ctrl-S) or a full pipe blocks no loop. A full queue
// drops messages. The thread writes their number when there is room again.
void write_stderr(std::string_view words);
// Waits until all words are written, at most `limit`. False: some are not.
bool stderr_written_within(Duration limit);
// spdlog says its words that way, too, in the name of this program.
void log_to_stderr(const std::string& program);

}  // namespace thimble
