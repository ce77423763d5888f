// The table [instructions]: a lab's own words, in its own language (UTF-8), for the pages that a subject reads between trials.
//   ready_title = "Bereit?"             in place of the page's title
//   ready = "Versuch {trial} von {trials}"   in place of its text, which may have several lines
// and the same for welcome, practice, break, paused, done and wait. Texts that are left out stay as in window/captions.cpp.
// Placeholders:
//   {trial}, {trials}   the coming trial and how many there are, practice and all; not {trial} on the page done
//   {break_s}           what is left of the break, in whole seconds; {break_time} the same as 1:05. On the page break only
// {{ and }} are braces.
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

    const PageWords& of(PageKind kind) const { return pages[static_cast<std::size_t>(kind)]; }
    // All their characters, which the font must have.
    std::string text() const;
};

// Throws Error (usage) on a placeholder that the page does not know, or a brace that stands alone.
Instructions read_instructions(const ConfigTable& table);

// The accepted text with the page's numbers in it.
std::string fill_in(std::string_view words, const Page& page);

// "1:05": what is left of a break, begun seconds as whole ones.
std::string break_time(const Page& page);

// A sentence for each page whose own words name a modality (HF, CF, CCF or VF as a word): a subject is not to know it.
std::vector<std::string> named_modalities(const Instructions& instructions);

}  // namespace thimble
