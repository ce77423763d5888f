// The experimenter's buttons, in rows of control_cell().
#pragma once

#include "visual_node/views/experimenter_model.hpp"
#include "visual_node/views/view_layout.hpp"

namespace thimble {

enum ControlRow : int {
    kSliderRow,
    kStepRow,
    kNetworkRow,  // and the next one
    kModalityRow = kNetworkRow + 2,
    kTrialRow,
    kAfterRow,
    kNoticeRow
};
inline constexpr int kNetworksPerRow = 3;

void draw_controls(const Rect& rect, double scale, ExperimenterModel& model, SessionTime now);
// The question that excluding asks, over everything; nothing while there is none.
void draw_question(double scale, ExperimenterModel& model, SessionTime now);

}  // namespace thimble
