// The cut-away view of players, videos and the experimenter: tissue cut along the needle. Not for subjects: it shows
// the fixture and the inserted needle. Pure arithmetic from a Scene to triangles and labels. Only lengths along z are
// to scale.
#pragma once

#include <string>
#include <vector>

#include "visual_node/display.hpp"
#include "visual_node/window/mesh.hpp"
#include "visual_node/window/picture.hpp"

namespace thimble {

// Layout in pixels of the framebuffer.
struct CutawayPlan {
    Rect area;
    double unit = 1;    // of sizes that do not follow z: 1 in an area of 600 pixels' height
    double per_m = 1;   // pixels
    double axis_x = 0;  // of the needle
    double block_left = 0, block_right = 0, block_bottom = 0;
    double rise = 0;  // how much higher the tissue's far edge stands

    double y(double z_m) const;  // kept near the area, NaN included
    double needle_width() const { return 11 * unit; }
};

// Of the axis z: from here to there the view reaches.
inline constexpr double kCutawayTop_m = -0.150, kCutawayBottom_m = 0.165;
// From the needle's tip to its hub. A tip that is deeper beneath the skin is drawn there, with an arrow that points down.
inline constexpr double kShaft_m = 0.132;
// Of the virtual wall's line.
inline constexpr Colour kWallLine{240, 176, 216};
// The longest arrow.
inline constexpr double kArrowFull_N = 12;

CutawayPlan plan_cutaway(const Rect& area);
// Of a scene with cut_away. Replaces what `mesh` had.
void build_cutaway(const Scene& scene, const CutawayPlan& plan, Mesh& mesh);

struct CutawayLabel {
    Spot at;  // the middle of its left edge; of its right edge if it ends there
    std::string text;
    Colour colour{};
    bool ends_there = false;
};
// Texts beside things: depth, force, where the force is felt.
std::vector<CutawayLabel> cutaway_labels(const Scene& scene, const CutawayPlan& plan);

}  // namespace thimble
