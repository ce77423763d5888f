#include "visual_node/window/page_text.hpp"

#include <fmt/format.h>

namespace thimble {
namespace {

constexpr const char* kTask =
    "Push the needle into the tissue until something stops it.\n"
    "Hold it there, no deeper and no harder, until you hear the beep.\n"
    "Then pull it out.";
constexpr const char* kGoOn = "Press the space bar, or click, when you are ready.";

std::string which_of(const Page& page) {
    if (page.trial == 0) return {};
    if (page.trials == 0) return fmt::format("Trial {}", page.trial);
    return fmt::format("Trial {} of {}", page.trial, page.trials);
}

std::string break_text(const Page& page) {
    if (page.remaining_s <= 0) return "Say when you want to go on.";
    return break_time(page) + " to go";
}

}  // namespace

PageText page_text(const Page& page) {
    switch (page.kind) {
        case PageKind::kNone:
            return {};
        case PageKind::kWelcome:
            return {"Welcome", kTask};
        case PageKind::kPractice:
            return {"Practice", std::string(kTask) + "\n\nThis one does not count."};
        case PageKind::kReady:
            return {"Ready?", which_of(page)};
        case PageKind::kBreak:
            return {"A break", break_text(page)};
        case PageKind::kPaused:
            return {"Paused", "It will go on in a moment."};
        case PageKind::kDone:
            return {"Done", "Thank you. You may let go."};
        case PageKind::kWait:
            return {"One moment", which_of(page)};
    }
    return {};
}

PageText page_text(const Page& page, const Instructions& instructions, bool subject_goes_on) {
    PageText text = page_text(page);
    if (page.kind == PageKind::kNone) return text;
    const PageWords& own = instructions.of(page.kind);
    if (own.title) text.title = fill_in(*own.title, page);
    if (own.body) {
        text.body = fill_in(*own.body, page);
    } else if (subject_goes_on && waits_to_go_on(page.kind)) {
        text.body += text.body.empty() ? kGoOn : std::string("\n\n") + kGoOn;
    }
    return text;
}

}  // namespace thimble
