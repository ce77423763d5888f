// The controls of a recorded trial in ImGui: a scrub bar with marks, steps, speeds.
#pragma once

#include "visual_node/views/replay_model.hpp"

namespace thimble {

// Within a window of ImGui, in its width.
void draw_replay(ReplayModel& model, const Monitor& monitor, double scale, SessionTime now);

}  // namespace thimble
