// The table [instructions]: a lab's own words, in its own language (UTF-8), for the pages that a subject reads between trials.
// docs/session-files.md lists the keys and the placeholders. Texts that are left out stay as in window/captions.cpp.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/config.hpp"
#include "common/messages.hpp"

namespace thimble {

struct PageWords {
    std::optional<std::string> title, body;  // as written; none: as it comes
};

struct Instructions {
    std::array<PageWords, kPageKinds> pages;  // by PageKind
    std::optional<std::string> go_on;         // how to go on, below pages that wait for the subject

    const PageWords& of(PageKind kind) const { return pages[static_cast<std::size_t>(kind)]; }
    // All their characters, which the font must have.
    std::string text() const;
};

// In place of those `given`. Throws Error (usage) on a placeholder that the page does not know, or a brace that stands alone.
Instructions read_instructions(const ConfigTable& table, Instructions given = {});

// A text that a subject reads; nothing if the key is absent. Throws Error (usage) if it is written from right to left.
std::optional<std::string> read_page_text(const ConfigTable& table, const std::string& key,
                                          std::string_view help);
void refuse_right_to_left(const ConfigTable& table, const std::string& key, std::string_view text);
// The first character (Unicode) of a script that is written from right to left, or that turns the direction; 0: none.
char32_t right_to_left(std::string_view text);
// The character at the beginning of UTF-8, taken off it. `text` is not empty.
char32_t take_character(std::string_view& text);

// The accepted text with the page's numbers in it.
std::string fill_in(std::string_view words, const Page& page);

// "1:05": what is left of a break, begun seconds as whole ones.
std::string break_time(const Page& page);

// A sentence for each page whose own words name a modality (HF, CF, CCF or VF as a word): a subject is not to know it.
std::vector<std::string> named_modalities(const Instructions& instructions);

}  // namespace thimble
