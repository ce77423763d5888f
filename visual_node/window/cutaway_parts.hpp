// The things that the cut-away view shows, each in triangles. For cutaway.cpp alone.
#pragma once

#include "visual_node/window/cutaway.hpp"

namespace thimble {

// Layers, dimple and tear. The skin behind the cut is seen from a little above.
void draw_tissue(Mesh& mesh, const Scene& scene, const CutawayPlan& plan);
void draw_fixture(Mesh& mesh, const CutAway& cut, const CutawayPlan& plan);
// Shaft with marks every 5 and 10 mm from the tip, and the hub.
void draw_needle(Mesh& mesh, const CutAway& cut, const CutawayPlan& plan);
// The right hand's fingers at the hub; in CCF the left hand's with the belt as well.
void draw_hands(Mesh& mesh, const Scene& scene, const CutawayPlan& plan);
// The outline of the hub where the hand wants it.
void draw_ghost(Mesh& mesh, const CutawayPlan& plan, double hub_y);

double hub_bottom(const CutawayPlan& plan, double position_needle_m);

}  // namespace thimble
