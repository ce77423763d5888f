// An experimenter's view of a participant session. Its orders arrive as typed lines.
#pragma once

#include <functional>

#include "session/run/condition_run.hpp"
#include "session/sitting/line_source.hpp"

namespace thimble {

struct SittingView {
    LineSource* lines;             // what it asks; never ends
    std::function<bool()> paused;  // no further trial while it is
    std::function<void(std::size_t trials)> planned;
    MakeObserver make_observer;
};

}  // namespace thimble
