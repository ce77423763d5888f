// The numbers of the newest Monitor in two columns, with its age. Greyed while the session is silent: they are old then.
#pragma once

#include "visual_node/views/replay_model.hpp"
#include "visual_node/views/session_link.hpp"
#include "visual_node/views/view_layout.hpp"

namespace thimble {

void draw_readings(const Rect& rect, const SessionLink& link, SessionTime now);

// The controls of a recorded trial in ImGui: a scrub bar with marks, steps, speeds.

// Within a window of ImGui, in its width.
void draw_replay(ReplayModel& model, const Monitor& monitor, double scale, SessionTime now);

}  // namespace thimble
