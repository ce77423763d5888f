// In place of render.cpp where there is nothing to draw with.
#include "common/error.hpp"
#include "session/render/render.hpp"

namespace thimble {

RenderResult render_trial(const RecordedTrial& /*trial*/, const RenderPlan& /*plan*/) {
    throw Error(ExitCode::kUsage,
                "this build has no windows (THIMBLE_GUI is off), so it cannot draw pictures");
}

}  // namespace thimble
