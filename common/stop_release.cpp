#include "common/stop_release.hpp"

#include <algorithm>

namespace thimble {

void StopRelease::round(SessionTime now) {
    inquiry_.hear(now);
    if (rounds_++ < kAskTimes) inquiry_.ask(now);
    for (const LatchedStop& held : inquiry_.held()) {
        const bool known = std::any_of(stops_.begin(), stops_.end(),
                                       [&held](const StopOrder& other) { return other.id == held.stop.id; });
        if (held.since_before && !known) stops_.push_back(held.stop);
    }
    for (const StopOrder& stop : stops_)
        out_.send(now, 0, StopOrder(stop.id, StopKind::kRelease, EndReason::kEmergencyStop, {}));
}

}  // namespace thimble
