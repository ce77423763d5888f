// The scene from the side, as only the experimenter may see it: z to the right, the needle with its inserted part, the
// surface, the fixture and the god-object, which stays at the fixture when the needle has gone through.
#pragma once

#include <imgui.h>

#include "common/messages.hpp"
#include "visual_node/views/view_layout.hpp"

namespace thimble {

void draw_side_view(ImDrawList& list, const Rect& rect, double scale, const Monitor& monitor);

}  // namespace thimble
