#include "session/launch/shell_words.hpp"

namespace thimble {

// Within '...' a shell looks at nothing but the closing quote (POSIX.1-2017, Shell Command Language, 2.2.2).
std::string shell_word(std::string_view text) {
    std::string word = "'";
    for (const char c : text) {
        if (c == '\'') {
            word += "'\\''";
        } else {
            word += c;
        }
    }
    return word + "'";
}

std::string shell_words(const std::vector<std::string>& words) {
    std::string line;
    for (const std::string& word : words) {
        if (!line.empty()) line += ' ';
        line += shell_word(word);
    }
    return line;
}

}  // namespace thimble
