// Plan, arrows and labels of the cut-away view. Tissue and needle have files of their own.
#include "visual_node/window/cutaway.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "visual_node/window/cutaway_parts.hpp"

namespace thimble {
namespace {

constexpr double kReference_px = 600;
constexpr double kLeastForce_N = 0.3;  // smaller ones have no arrow
constexpr Colour kGroundTop{24, 28, 36}, kGroundBottom{66, 74, 88};

double total_N(const CutAway& cut) { return cut.force_tissue_N + cut.force_fixture_N; }
// Limits the depth to the needle's length: its hub must stay outside the tissue.
double deepest_m(const Scene& scene) { return scene.position_surface_rest_m + kShaft_m; }
double tip_m(const Scene& scene) { return std::min(scene.cut_away->position_needle_m, deepest_m(scene)); }

// Force as a weight, which visitors understand better than newtons.
std::string weight_text(double force_N) {
    constexpr double kGravity_m_per_s2 = 9.81;
    const double kg = std::abs(force_N) / kGravity_m_per_s2;
    if (kg < 1) return fmt::format("like {:.0f} g", 10 * std::round(100 * kg));
    return kg < 10 ? fmt::format("like {:.1f} kg", kg) : fmt::format("like {:.0f} kg", kg);
}
// Beside the needle of a narrow scene there is room for numbers alone, and none on the wall's line.
bool narrow(const CutawayPlan& plan) { return plan.area.width < 0.6 * plan.area.height; }

std::string force_text(double force_N, const CutawayPlan& plan) {
    const std::string number = fmt::format("{:.1f} N", std::abs(force_N));
    return narrow(plan) ? number : number + ", " + weight_text(force_N);
}

bool touches(double force_N) { return std::abs(force_N) > kLeastForce_N; }

double arrow_length(double force_N, const CutawayPlan& plan) {
    const double share = std::clamp(std::abs(force_N) / kArrowFull_N, 0.0, 1.0);
    return (14 + 120 * share) * plan.unit;
}

// From `from`, up where the force resists.
void draw_arrow(Mesh& mesh, const Spot& from, double force_N, const CutawayPlan& plan, const Colour& colour) {
    const double up = force_N < 0 ? -1 : 1, u = plan.unit, length = arrow_length(force_N, plan);
    const Spot head{from.x, from.y + up * length}, neck{from.x, head.y - up * 11 * u};
    mesh.stroke({from.x + 2 * u, from.y + 2 * u}, {neck.x + 2 * u, neck.y + 2 * u}, 6 * u, {0, 0, 0, 0.35F});
    mesh.stroke(from, neck, 5 * u, ink(colour));
    const std::array corners{head, Spot{neck.x - 8 * u, neck.y}, Spot{neck.x + 8 * u, neck.y}};
    mesh.polygon(corners, ink(colour));
}

// A zigzag between two places on an axis: the spring of the coupling, or of the fixture.
void draw_spring(Mesh& mesh, double x, double from, double to, const CutawayPlan& plan, const Ink& colour) {
    constexpr int kTurns = 9;
    std::array<Spot, kTurns + 1> points;
    for (int i = 0; i <= kTurns; ++i) {
        const double side = i == 0 || i == kTurns ? 0 : (i % 2 == 0 ? 6 : -6) * plan.unit;
        points[static_cast<std::size_t>(i)] = {x + side, from + (to - from) * i / kTurns};
    }
    mesh.path(points, 2 * plan.unit, colour);
}

// The god-object stays at the fixture when the needle has gone through, and a spring draws the needle back to it.
void draw_god_object(Mesh& mesh, const CutAway& cut, const CutawayPlan& plan) {
    if (!cut.fixture_present) return;
    const double tip = plan.y(cut.position_needle_m);
    const double proxy = plan.y(std::min(cut.position_needle_m, cut.position_fixture_m));
    if (tip - proxy > 20 * plan.unit)
        draw_spring(mesh, plan.axis_x + 20 * plan.unit, proxy, tip, plan, ink(kYellow, 0.9));
    mesh.ring({plan.axis_x, proxy}, 9 * plan.unit, 2.5 * plan.unit, ink(kYellow));
}

void draw_hand_ghost(Mesh& mesh, const CutAway& cut, const CutawayPlan& plan) {
    if (!cut.position_hand_m) return;
    const double hub = hub_bottom(plan, cut.position_needle_m),
                 ghost = hub_bottom(plan, *cut.position_hand_m);
    if (std::abs(ghost - hub) < 2 * plan.unit) return;
    draw_ghost(mesh, plan, ghost);
    if (std::abs(ghost - hub) < 20 * plan.unit) return;
    draw_spring(mesh, plan.axis_x - 34 * plan.unit, hub, ghost, plan, ink(kWhite, 0.7));
}

// Of VF. The labels have the numbers of its scale.
Picture::Bar bar_of(const Scene& scene, const CutawayPlan& plan) {
    Picture::Bar bar;
    bar.full_N = scene.bar_full_scale_N;
    bar.left = std::floor(plan.area.x + 22 * plan.unit);
    bar.full_length = std::floor(std::max(40.0, 0.29 * plan.area.width));
    bar.length = std::round(std::clamp(scene.bar_N / bar.full_N, 0.0, 1.0) * bar.full_length);
    bar.height = std::round(26 * plan.unit);
    bar.top = std::round(plan.y(-0.062));
    bar.tick_N = bar_tick_N(bar.full_N);
    return bar;
}

void draw_bar(Mesh& mesh, const Picture::Bar& bar, const CutawayPlan& plan) {
    const double bottom = bar.top + bar.height;
    const auto box = [&](double length, const Ink& colour) {
        mesh.box_down({bar.left, bar.top}, {bar.left + length, bottom}, colour, colour);
    };
    box(bar.full_length, ink(kWhite, 0.25));
    box(bar.length, ink(colours::kBar));
    const double line = std::max(1.0, std::round(plan.unit));
    const int ticks = static_cast<int>(std::floor(bar.full_N / bar.tick_N * (1 + 1e-12)));
    for (int i = 0; i <= ticks; ++i) {
        const double x = std::round(bar.left + bar.full_length * i * bar.tick_N / bar.full_N);
        mesh.box_down({x, bottom}, {x + line, bottom + 6 * plan.unit}, ink(kWhite), ink(kWhite));
    }
}

// Beneath a tip that has gone on.
void draw_deeper(Mesh& mesh, const CutawayPlan& plan, double tip_y) {
    const double u = plan.unit, x = plan.axis_x, top = tip_y + 3 * u;
    const std::array corners{Spot{x - 13 * u, top}, Spot{x + 13 * u, top}, Spot{x, top + 15 * u}};
    mesh.polygon(corners, ink(kYellow));
}

void draw_ground(Mesh& mesh, const CutawayPlan& plan) {
    const Rect& a = plan.area;
    mesh.box_down({a.x, a.y}, {a.right(), a.bottom()}, ink(kGroundTop), ink(kGroundBottom));
    mesh.disc({plan.axis_x, plan.y(0)}, {0.7 * a.width, 0.45 * a.height}, {0.75F, 0.85F, 1, 0.16F},
              {0.75F, 0.85F, 1, 0});
    const double middle = (plan.block_left + plan.block_right) / 2;
    mesh.disc({middle, plan.block_bottom}, {0.62 * (plan.block_right - plan.block_left), 22 * plan.unit},
              {0, 0, 0, 0.75F}, {0, 0, 0, 0});
}

// Where a player feels the force, in a visitor's words.
const char* felt_at(Modality modality) {
    static constexpr std::array kNames{"force in the hand", "force on the fingertip",
                                       "force on the other hand", "force as a bar"};
    return kNames.at(static_cast<std::size_t>(modality));
}

}  // namespace

double CutawayPlan::y(double z_m) const {
    constexpr double kBeyond_m = 0.1;
    const double low = kCutawayTop_m - kBeyond_m, high = kCutawayBottom_m + kBeyond_m;
    const double held_m = z_m > low ? std::min(z_m, high) : low;
    return area.y + (held_m - kCutawayTop_m) * per_m;
}

CutawayPlan plan_cutaway(const Rect& area) {
    CutawayPlan plan;
    plan.area = area;
    plan.unit = std::max(0.2, std::min(area.height / kReference_px, area.width / 480));
    plan.per_m = area.height / (kCutawayBottom_m - kCutawayTop_m);
    plan.axis_x = std::floor(area.x + 0.54 * area.width);
    const double margin = std::min(0.06 * area.width, 40 * plan.unit);
    plan.block_left = area.x + margin;
    plan.block_right = area.right() - margin;
    plan.block_bottom = area.bottom() - 16 * plan.unit;
    plan.rise = 46 * plan.unit;
    return plan;
}

void build_cutaway(const Scene& scene, const CutawayPlan& plan, Mesh& mesh) {
    mesh.clear();
    Scene shown = scene;
    shown.cut_away->position_needle_m = tip_m(scene);
    const CutAway& cut = *shown.cut_away;
    draw_ground(mesh, plan);
    draw_tissue(mesh, shown, plan);
    draw_fixture(mesh, cut, plan);
    draw_needle(mesh, cut, plan);
    draw_god_object(mesh, cut, plan);
    draw_hands(mesh, shown, plan);
    draw_hand_ghost(mesh, cut, plan);
    if (scene.bar_shown) draw_bar(mesh, bar_of(scene, plan), plan);
    if (scene.cut_away->position_needle_m > deepest_m(scene))
        draw_deeper(mesh, plan, plan.y(cut.position_needle_m));
    const double total = total_N(cut);
    if (touches(total))
        draw_arrow(mesh, {plan.axis_x - 24 * plan.unit, plan.y(cut.position_needle_m)}, total, plan,
                   kVermillion);
    if (cut.modality == Modality::kHF && touches(total)) {
        draw_arrow(mesh, {plan.axis_x + 100 * plan.unit, hub_bottom(plan, cut.position_needle_m)}, total,
                   plan, kOrange);
    }
}

std::vector<CutawayLabel> cutaway_labels(const Scene& scene, const CutawayPlan& plan) {
    const CutAway& cut = *scene.cut_away;
    const double u = plan.unit, rest_m = scene.position_surface_rest_m;
    std::vector<CutawayLabel> labels;
    labels.reserve(16);
    // Every 20 mm beneath the skin, at the block's left edge.
    for (int depth_mm = 20; depth_mm <= 120; depth_mm += 20) {
        labels.push_back({{plan.block_left + 16 * u, plan.y(rest_m + depth_mm * 1e-3)},
                          fmt::format("{}{}", depth_mm, depth_mm == 20 ? " mm" : ""),
                          kWhite});
    }
    if (cut.fixture_present && !narrow(plan)) {
        labels.push_back({{plan.block_right - 10 * u, plan.y(cut.position_fixture_m) - 14 * u},
                          "virtual wall",
                          colours::kInk,
                          true});
    }
    const double total = total_N(cut), aside = narrow(plan) ? 0.035 * plan.area.height : 9 * u;
    const double tip = plan.y(tip_m(scene)), hub = hub_bottom(plan, tip_m(scene));
    if (touches(total))
        labels.push_back({{plan.axis_x - 40 * u, tip - aside}, force_text(total, plan), kWhite, true});
    if (cut.phase == TissuePhase::kPenetrated) {
        const double depth_mm = 1e3 * (cut.position_needle_m - rest_m);
        labels.push_back(
            {{plan.axis_x + 36 * u, tip + aside}, fmt::format("{:.0f} mm deep", depth_mm), kWhite});
    }
    labels.push_back({{plan.area.x + 22 * u, plan.y(-0.080)}, felt_at(cut.modality), kWhite});
    if (cut.position_hand_m && std::abs(*cut.position_hand_m - cut.position_needle_m) > 0.02)
        labels.push_back(
            {{plan.axis_x + 66 * u, hub_bottom(plan, *cut.position_hand_m) - 46 * u}, "your hand", kWhite});
    if (cut.modality == Modality::kCCF)
        labels.push_back({{plan.axis_x + 60 * u, hub - 10 * u}, "moving hand", colours::kInk});
    if (scene.bar_shown) {
        const Picture::Bar bar = bar_of(scene, plan);
        const double y = bar.top + bar.height + 16 * u;
        labels.push_back({{bar.left, y}, "0", kWhite});
        labels.push_back({{bar.left + bar.full_length, y}, fmt::format("{:g} N", bar.full_N), kWhite, true});
    }
    return labels;
}

}  // namespace thimble
