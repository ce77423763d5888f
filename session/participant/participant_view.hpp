// An experimenter's view of a participant session. Its orders arrive as typed lines.
#pragma once

#include <functional>

#include "session/participant/line_source.hpp"
#include "session/run/condition_run.hpp"

namespace thimble {

struct ParticipantView {
    LineSource* lines;             // what it asks; never ends
    std::function<bool()> paused;  // no further trial while it is
    std::function<void(std::size_t trials)> planned;
    MakeObserver make_observer;
};

}  // namespace thimble
