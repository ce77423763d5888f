// The three descriptors that every program is given: none of them is missing, and nobody who reads words for people can hold
// up the program that says them.
#pragma once

#include <string>
#include <string_view>

#include "common/time.hpp"

namespace thimble {

// Opens /dev/null in the place of each one that is closed, or the next file would take its number. Comes first in every program.
void open_standard_descriptors();

// A thread of its own writes these words to stderr; the caller never waits. A terminal that is held (Ctrl-S) and a pipe that
// nobody reads so hold up no loop. Words that find the queue full are dropped, and their number is written when there is room.
void say_words(std::string_view words);
// Waits until all words are written, at most `limit`. False: some are not.
bool words_written_within(Duration limit);
// spdlog says its words that way, too, in the name of this program.
void log_by_words(const std::string& program);

}  // namespace thimble
