// What a subject reads between trials. Never the modality's name, never anything of the fixture.
#pragma once

#include <string>

#include "common/messages.hpp"

namespace thimble {

struct PageText {
    std::string title;
    std::string body;  // lines; may be empty
};

// Empty for kNone.
PageText page_text(const Page& page);

}  // namespace thimble
