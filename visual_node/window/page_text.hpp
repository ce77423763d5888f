// The text for a subject between trials. Never the modality's name, never anything of the fixture, unless a lab's own words do.
#pragma once

#include <string>

#include "common/messages.hpp"
#include "visual_node/instructions.hpp"

namespace thimble {

struct PageText {
    std::string title;
    std::string body;  // lines; may be empty
};

// Empty for kNone.
PageText page_text(const Page& page);
// With a lab's own words where it has some. `subject_goes_on`: a text that is not its own says how, where the page waits for that.
PageText page_text(const Page& page, const Instructions& instructions, bool subject_goes_on);

}  // namespace thimble
