// Words for a POSIX shell.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace thimble {

// One word that the shell takes as it is, whatever it holds (but no NUL).
std::string shell_word(std::string_view text);
// Several, with blanks between.
std::string shell_words(const std::vector<std::string>& words);

}  // namespace thimble
