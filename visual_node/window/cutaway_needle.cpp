#include <algorithm>
#include <array>
#include <cmath>

#include "visual_node/window/cutaway_parts.hpp"

namespace thimble {
namespace {

constexpr Colour kSteel{214, 220, 228}, kMark{28, 30, 36}, kHub{40, 128, 196}, kStrap{36, 62, 140};
constexpr double kTip_m = 0.009;  // of the taper

// A round rod: dark edges, and a highlight left of its middle.
void draw_rod(Mesh& mesh, const Spot& from, const Spot& to, const Ink& colour) {
    constexpr std::array<std::pair<double, double>, 6> kLight{
        {{0, 0.42}, {0.18, 0.82}, {0.34, 1.16}, {0.5, 0.98}, {0.8, 0.6}, {1, 0.32}}};
    for (std::size_t i = 1; i < kLight.size(); ++i) {
        const auto [left, light] = kLight[i - 1];
        const auto [right, next] = kLight[i];
        mesh.box_across({std::lerp(from.x, to.x, left), from.y}, {std::lerp(from.x, to.x, right), to.y},
                        lit(colour, light), lit(colour, next));
    }
}

void draw_point(Mesh& mesh, const CutawayPlan& plan, double shoulder, double tip) {
    const double half = plan.needle_width() / 2, x = plan.axis_x;
    const std::array left{Spot{x - half, shoulder}, Spot{x, shoulder}, Spot{x, tip}};
    const std::array right{Spot{x, shoulder}, Spot{x + half, shoulder}, Spot{x, tip}};
    mesh.polygon(left, ink({236, 240, 246}));
    mesh.polygon(right, ink({128, 134, 144}));
}

// Bands every 10 mm from the tip, shorter ticks half way; every 50 mm a coloured band.
void draw_shaft_marks(Mesh& mesh, const CutawayPlan& plan, double position_m) {
    const double half = plan.needle_width() / 2, u = plan.unit;
    for (int i = 2; i * 0.005 < kShaft_m - 0.002; ++i) {
        const double y = plan.y(position_m - i * 0.005);
        if (y < plan.area.y - 4 * u) break;
        const bool band = i % 2 == 0;
        const double high = (band ? 2.0 : 0.9) * u, left = band ? -half : -0.1 * half;
        const Ink colour = i % 10 == 0 ? ink(kVermillion) : ink(kMark, band ? 1 : 0.8);
        mesh.box_down({plan.axis_x + left, y - high}, {plan.axis_x + half, y + high}, colour, colour);
    }
}

void draw_hub(Mesh& mesh, const CutawayPlan& plan, double bottom) {
    const double u = plan.unit, half = plan.needle_width() / 2, wide = 17 * u, x = plan.axis_x;
    const double neck = bottom - 16 * u, top = bottom - 84 * u;
    const std::array cone_left{Spot{x - wide, neck}, Spot{x, neck}, Spot{x, bottom}, Spot{x - half, bottom}};
    const std::array cone_right{Spot{x, neck}, Spot{x + wide, neck}, Spot{x + half, bottom}, Spot{x, bottom}};
    mesh.polygon(cone_left, lit(ink(kHub), 1.05));
    mesh.polygon(cone_right, lit(ink(kHub), 0.6));
    draw_rod(mesh, {x - wide, top}, {x + wide, neck}, ink(kHub));
    for (int i = 0; i < 4; ++i) {
        const double y = neck - (10 + 14 * i) * u;
        mesh.box_down({x - wide, y}, {x + wide, y + 2 * u}, {0, 0, 0, 0.28F}, {0, 0, 0, 0.28F});
    }
    draw_rod(mesh, {x - 8 * u, std::min(plan.area.y, top)}, {x + 8 * u, top}, ink({120, 128, 140}));
}

struct Finger {
    Spot tip;           // of the pad, where it touches
    double side = 1;    // 1: comes from the right, -1: from the left
    double radius = 1;  // pixels
    double length = 1;
    double pressed = 0;  // 0 to 1
    bool belt = false;
};

// Flattened by the belt: its height shrinks near the tip.
double half_height(const Finger& finger, double along) {
    const double squeeze =
        finger.belt ? 0.30 * finger.pressed * std::exp(-std::pow((along - 1.0) / 0.6, 2)) : 0;
    const double round =
        along < 1 ? std::sqrt(std::max(0.0, 1 - (1 - along) * (1 - along))) : 1 + 0.06 * (along - 1);
    return finger.radius * round * (1 - squeeze);
}

Ink skin_at(const Finger& finger, double along, double across) {
    const double pale = finger.pressed * std::clamp(1.5 - along, 0.0, 1.0);
    const double light = 0.62 + 0.5 * std::cos(1.25 * (across + 0.45)) - 0.12 * (across > 0 ? across : 0);
    const double end = finger.length / finger.radius;
    const double shown = std::clamp((end - along) / (0.45 * end), 0.0, 1.0);
    return faded(lit(mix(ink(colours::kSkin), ink(colours::kBlanched), pale), std::clamp(light, 0.35, 1.1)),
                 shown);
}

// Along the finger from its tip in steps of its radius; across it from its upper edge to its lower.
void draw_flesh(Mesh& mesh, const Finger& finger) {
    constexpr int kAlong = 22, kAcross = 8;
    const double reach = finger.length / finger.radius;
    const auto along = [&](int i) { return reach * std::pow(double(i) / kAlong, 1.6); };
    const auto spot = [&](int i, int j) {
        const double a = along(i), c = 2.0 * j / kAcross - 1;
        return Spot{finger.tip.x + finger.side * a * finger.radius,
                    finger.tip.y + c * half_height(finger, a)};
    };
    const auto colour = [&](int i, int j) { return skin_at(finger, along(i), 2.0 * j / kAcross - 1); };
    for (int i = 0; i < kAlong; ++i) {
        for (int j = 0; j < kAcross; ++j) {
            mesh.quad({spot(i, j), spot(i + 1, j), spot(i + 1, j + 1), spot(i, j + 1)},
                      {colour(i, j), colour(i + 1, j), colour(i + 1, j + 1), colour(i, j + 1)});
        }
        const Ink rim = faded({0.25F, 0.08F, 0.06F, 0.6F}, static_cast<double>(colour(i + 1, 0).a));
        for (const int edge : {0, kAcross}) mesh.stroke(spot(i, edge), spot(i + 1, edge), 1.6, rim);
    }
}

void draw_nail(Mesh& mesh, const Finger& finger) {
    const double r = finger.radius, x = finger.tip.x + finger.side * 0.75 * r;
    const Ink nail = mix(ink({240, 168, 150}), ink(colours::kBlanched), finger.pressed);
    mesh.disc({x, finger.tip.y - 0.42 * half_height(finger, 0.8)}, {0.52 * r, 0.30 * r}, lit(nail, 1.08),
              nail);
}

// The strap of the device, and its box with the motor above the finger.
void draw_belt(Mesh& mesh, const Finger& finger) {
    const double r = finger.radius, near = finger.tip.x + finger.side * 0.95 * r,
                 far = near + finger.side * 0.9 * r;
    const double half = half_height(finger, 1.2) + 0.10 * r;
    const Ink strap = mix(ink(kStrap), ink(kSkyBlue), 0.55 * finger.pressed);
    const double left = std::min(near, far), right = std::max(near, far), y = finger.tip.y;
    mesh.box_down({left, y - half}, {right, y - 0.2 * half}, lit(strap, 1.25), strap);
    mesh.box_down({left, y - 0.2 * half}, {right, y + half}, strap, lit(strap, 0.5));
    const double box = y - half - 0.62 * r;
    mesh.box_down({left - 0.1 * r, box}, {right + 0.1 * r, y - half + 0.08 * r}, ink({92, 98, 110}),
                  ink({50, 54, 62}));
    mesh.box_down({left - 0.1 * r, box}, {right + 0.1 * r, box + 2}, ink({170, 178, 190}),
                  ink({170, 178, 190}));
}

void draw_finger(Mesh& mesh, const Finger& finger) {
    draw_flesh(mesh, finger);
    draw_nail(mesh, finger);
    if (finger.belt) draw_belt(mesh, finger);
}

// Index finger and thumb. `gap`: between them.
void draw_pair(Mesh& mesh, const Spot& middle, double gap, double unit, const Scene& scene, bool belts) {
    const double index = std::clamp(scene.fingertip_N / kBlanched_N, 0.0, 1.0),
                 thumb = std::clamp(scene.thumb_N / kBlanched_N, 0.0, 1.0);
    draw_finger(mesh, {{middle.x + gap / 2, middle.y}, 1, 17 * unit, 130 * unit, belts ? index : 0, belts});
    draw_finger(
        mesh,
        {{middle.x - gap / 2, middle.y + 6 * unit}, -1, 19 * unit, 120 * unit, belts ? thumb : 0, belts});
}

// Where the fingers of the hand that does not move the needle are in CCF.
Spot other_hand(const CutawayPlan& plan) { return {plan.area.x + 0.19 * plan.area.width, plan.y(-0.050)}; }

}  // namespace

double hub_bottom(const CutawayPlan& plan, double position_needle_m) {
    return plan.y(position_needle_m - kShaft_m);
}

void draw_needle(Mesh& mesh, const CutAway& cut, const CutawayPlan& plan) {
    const double half = plan.needle_width() / 2, tip = plan.y(cut.position_needle_m);
    const double shoulder = plan.y(cut.position_needle_m - kTip_m),
                 hub = hub_bottom(plan, cut.position_needle_m);
    const double top = std::max(hub, plan.area.y - 8);
    if (shoulder > top)
        draw_rod(mesh, {plan.axis_x - half, top}, {plan.axis_x + half, shoulder}, ink(kSteel));
    draw_point(mesh, plan, shoulder, tip);
    draw_shaft_marks(mesh, plan, cut.position_needle_m);
    draw_hub(mesh, plan, hub);
}

void draw_hands(Mesh& mesh, const Scene& scene, const CutawayPlan& plan) {
    const CutAway& cut = *scene.cut_away;
    const double u = plan.unit, hub = hub_bottom(plan, cut.position_needle_m);
    draw_pair(mesh, {plan.axis_x, hub - 46 * u}, 32 * u, u, scene, cut.modality == Modality::kCF);
    if (cut.modality != Modality::kCCF) return;
    draw_pair(mesh, other_hand(plan), 14 * u, u, scene, true);
}

void draw_ghost(Mesh& mesh, const CutawayPlan& plan, double hub_y) {
    const double u = plan.unit, x = plan.axis_x;
    const std::array outline{Spot{x - 60 * u, hub_y - 64 * u}, Spot{x + 60 * u, hub_y - 64 * u},
                             Spot{x + 60 * u, hub_y - 28 * u}, Spot{x + 17 * u, hub_y - 16 * u},
                             Spot{x - 17 * u, hub_y - 16 * u}, Spot{x - 60 * u, hub_y - 28 * u}};
    mesh.polygon(outline, ink(kWhite, 0.16));
    for (std::size_t i = 0; i < outline.size(); ++i)
        mesh.stroke(outline[i], outline[(i + 1) % outline.size()], 2 * u, ink(kWhite, 0.55));
}

}  // namespace thimble
