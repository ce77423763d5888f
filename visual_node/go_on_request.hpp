// A subject's request to go on, on its way to the session: said until the page is turned, because UDP loses messages, and for no other
// page than the one that was read.
#pragma once

#include "common/messages.hpp"
#include "common/time.hpp"

namespace thimble {

class GoOnRequest {
  public:
    static constexpr Duration kLook = std::chrono::milliseconds{20};    // for a key, while a page waits
    static constexpr Duration kRepeat = std::chrono::milliseconds{50};  // as a view's orders
    static constexpr Duration kPatience = std::chrono::seconds{2};      // then the session will not

    // `enabled`: the protocol lets the subject go on.
    explicit GoOnRequest(bool enabled) : enabled_(enabled) {}

    // The page shown now; the same one again changes nothing.
    void turn(SessionTime now, const Page& page);
    void press(SessionTime now);
    // Whether to say it now.
    bool take_due(SessionTime now);
    // When to look for a key and call take_due() again; kNever while no page waits.
    SessionTime next() const { return next_look_; }

  private:
    bool enabled_;
    bool wanted_ = false;
    PageKind kind_ = PageKind::kNone;
    std::uint32_t trial_ = 0;
    SessionTime next_look_ = kNever, next_saying_{}, until_{};
};

}  // namespace thimble
