#include <algorithm>
#include <array>
#include <cmath>

#include "visual_node/window/cutaway_parts.hpp"

namespace thimble {
namespace {

constexpr int kCutColumns = 72, kCutRows = 12;
constexpr double kFade_m = 0.030;  // a dimple fades with the depth by this length

struct Layer {
    double from_m, to_m;  // beneath the surface
    Colour top, bottom;
};
constexpr Colour kSkinTop{232, 184, 154};
constexpr std::array kLayers{Layer{0, 0.0022, {244, 206, 180}, {236, 178, 152}},
                             Layer{0.0022, 0.008, {216, 132, 116}, {202, 112, 100}},
                             Layer{0.008, 0.024, {228, 196, 122}, {206, 166, 92}},
                             Layer{0.024, 0.060, {150, 62, 58}, {126, 48, 50}},
                             Layer{0.060, 0.200, {126, 48, 50}, {70, 26, 36}}};

class Tissue {
  public:
    Tissue(Mesh& mesh, const Scene& scene, const CutawayPlan& plan)
        : mesh_(mesh),
          plan_(plan),
          rest_m_(scene.position_surface_rest_m),
          dent_m_(std::clamp(scene.position_surface_m - rest_m_, -0.03, 0.06)),
          torn_(scene.cut_away->phase == TissuePhase::kPenetrated),
          tip_m_(scene.cut_away->position_needle_m) {}

    void draw() {
        draw_skin();
        draw_shadow();
        for (const Layer& layer : kLayers) draw_layer(layer);
        draw_fibres();
        draw_edges();
        if (torn_) draw_tear();
    }

  private:
    double x(int column) const {
        // Finer towards the needle, where the dimple is.
        const double t = 2.0 * column / kCutColumns - 1, spread = 0.3 * t + 0.7 * t * t * t;
        const double side = spread < 0 ? plan_.axis_x - plan_.block_left : plan_.block_right - plan_.axis_x;
        return plan_.axis_x + spread * side;
    }
    // Of a flat punch, as painter.cpp has it; `back` in pixels behind the cut.
    double dent(double at_x, double back, double depth_m) const {
        const double radius = kDimple_m * plan_.per_m, r = std::hypot(at_x - plan_.axis_x, back);
        const double share = r <= radius ? 1 : 2 / 3.14159265 * std::asin(radius / r);
        return dent_m_ * share * std::exp(-depth_m / kFade_m);
    }
    Spot cut(int column, double depth_m) const {
        const double at_x = x(column), z_m = rest_m_ + depth_m + dent(at_x, 0, depth_m);
        return {at_x, std::min(plan_.y(z_m), plan_.block_bottom)};
    }
    Spot skin(int column, int row) const {
        const double back = plan_.rise * row / kCutRows, narrow = 1 - 0.06 * row / kCutRows;
        const double at_x = plan_.axis_x + (x(column) - plan_.axis_x) * narrow;
        return {at_x, plan_.y(rest_m_ + dent(at_x, 2.2 * back, 0)) - back};
    }
    Ink skin_ink(int column, int row) const {
        const double step = 0.6 * kDimple_m * plan_.per_m, at_x = x(column),
                     back = 2.2 * plan_.rise * row / kCutRows;
        const double slope_x =
            (dent(at_x + step, back, 0) - dent(at_x - step, back, 0)) * plan_.per_m / (2 * step);
        const double slope_y =
            (dent(at_x, back + step, 0) - dent(at_x, back - step, 0)) * plan_.per_m / (2 * step);
        // Light from the upper left, in front.
        const double length = std::sqrt(slope_x * slope_x + slope_y * slope_y + 1);
        const double light = (0.45 * -slope_x - 0.3 * slope_y + 0.84) / length;
        return lit(ink(kSkinTop), std::clamp(0.30 + 0.78 * light - 0.16 * row / kCutRows, 0.2, 1.15));
    }
    // Away from the lamp the block gets darker.
    double light_at(double at_x) const {
        return 1.04 - 0.26 * (at_x - plan_.block_left) / (plan_.block_right - plan_.block_left);
    }

    void draw_skin() {
        for (int row = kCutRows; row > 0; --row) {
            for (int i = 0; i < kCutColumns; ++i) {
                mesh_.quad(
                    {skin(i, row), skin(i + 1, row), skin(i + 1, row - 1), skin(i, row - 1)},
                    {skin_ink(i, row), skin_ink(i + 1, row), skin_ink(i + 1, row - 1), skin_ink(i, row - 1)});
            }
        }
    }
    // Of needle and hand on the skin: wider and weaker the higher the hand is.
    void draw_shadow() {
        const double entry = plan_.y(rest_m_ + dent_m_), u = plan_.unit;
        const double high = std::clamp((entry - plan_.y(tip_m_ - kShaft_m)) / (300 * u), 0.0, 1.0);
        mesh_.disc({plan_.axis_x + (40 + 60 * high) * u, plan_.y(rest_m_) - 0.5 * plan_.rise},
                   {(60 + 60 * high) * u, 0.4 * plan_.rise},
                   {0.1F, 0.02F, 0.02F, static_cast<float>(0.45 - 0.3 * high)}, {0.1F, 0.02F, 0.02F, 0});
        if (torn_ || tip_m_ > rest_m_ + dent_m_ - 0.02) {
            mesh_.disc({plan_.axis_x + 5 * u, entry - 3 * u}, {26 * u, 9 * u}, {0.15F, 0.03F, 0.02F, 0.55F},
                       {0.15F, 0.03F, 0.02F, 0});
        }
    }
    void draw_layer(const Layer& layer) {
        constexpr int kSteps = 3;
        for (int step = 0; step < kSteps; ++step) {
            const auto depth = [&](int s) { return std::lerp(layer.from_m, layer.to_m, double(s) / kSteps); };
            const Ink top = mix(ink(layer.top), ink(layer.bottom), double(step) / kSteps),
                      bottom = mix(ink(layer.top), ink(layer.bottom), double(step + 1) / kSteps);
            for (int i = 0; i < kCutColumns; ++i) {
                const Spot a = cut(i, depth(step)), b = cut(i + 1, depth(step)),
                           c = cut(i + 1, depth(step + 1)), d = cut(i, depth(step + 1));
                if (a.y >= plan_.block_bottom && b.y >= plan_.block_bottom) continue;
                const double left = light_at(a.x), right = light_at(b.x);
                mesh_.quad({a, b, c, d},
                           {lit(top, left), lit(top, right), lit(bottom, right), lit(bottom, left)});
            }
        }
    }
    void line(double depth_m, double width, const Ink& colour, double wave = 0) {
        Spot before = cut(0, depth_m);
        for (int i = 2; i <= kCutColumns; i += 2) {
            const double sway = wave * std::sin(0.021 * x(i) / plan_.unit + 900 * depth_m);
            const Spot here = cut(i, depth_m + sway);
            if (here.y < plan_.block_bottom - 1) mesh_.stroke(before, here, width, colour);
            before = here;
        }
    }
    void draw_fibres() {
        for (double depth_m = 0.029; depth_m < 0.128; depth_m += 0.0075)
            line(depth_m, 2.2 * plan_.unit, {1, 0.72F, 0.62F, 0.13F}, 0.0016);
    }
    void draw_edges() {
        const double u = plan_.unit;
        for (std::size_t i = 1; i < kLayers.size() - 1; ++i)
            line(kLayers[i].from_m, 1.3 * u, {0.25F, 0.08F, 0.06F, 0.55F});
        line(0, 2 * u, {1, 0.93F, 0.86F, 0.9F});
        const double top = plan_.y(rest_m_);
        mesh_.box_across({plan_.block_left, top}, {plan_.block_left + 14 * u, plan_.block_bottom},
                         {0, 0, 0, 0.35F}, {0, 0, 0, 0});
        mesh_.box_across({plan_.block_right - 30 * u, top}, {plan_.block_right, plan_.block_bottom},
                         {0, 0, 0, 0}, {0, 0, 0, 0.4F});
        mesh_.box_down({plan_.block_left, plan_.block_bottom - 24 * u},
                       {plan_.block_right, plan_.block_bottom}, {0, 0, 0, 0}, {0, 0, 0, 0.4F});
        for (int depth_mm = 10; depth_mm <= 120; depth_mm += 10) {
            const double y = std::floor(plan_.y(rest_m_ + depth_mm * 1e-3)),
                         long_one = depth_mm % 20 == 0 ? 12 : 6;
            mesh_.box_down({plan_.block_left, y - 1}, {plan_.block_left + long_one * u, y + 1},
                           ink(kWhite, 0.9), ink(kWhite, 0.9));
        }
    }
    // The channel that the needle has cut, and the torn lips of the skin beside it.
    void draw_tear() {
        const double half = plan_.needle_width() / 2, u = plan_.unit, entry = plan_.y(rest_m_ + dent_m_);
        const double tip = std::min(plan_.y(tip_m_) + 4 * u, plan_.block_bottom);
        const Ink dark{0.16F, 0.02F, 0.03F, 0.7F}, clear = faded(dark, 0);
        for (const double side : {-1.0, 1.0}) {
            const double inner = plan_.axis_x + side * half, outer = inner + side * 9 * u;
            if (tip > entry)
                mesh_.quad({Spot{inner, entry}, {outer, entry}, {inner, tip}, {inner, tip}},
                           {dark, clear, dark, dark});
            mesh_.disc({inner + side * 6 * u, entry}, {9 * u, 5 * u}, ink({222, 120, 104}),
                       ink(kSkinTop, 0.2));
            mesh_.stroke({inner, entry + 5 * u}, {inner + side * 5 * u, entry - 3 * u}, 2 * u,
                         ink({150, 40, 40}));
        }
    }

    Mesh& mesh_;
    const CutawayPlan& plan_;
    double rest_m_, dent_m_;
    bool torn_;
    double tip_m_;
};

}  // namespace

void draw_tissue(Mesh& mesh, const Scene& scene, const CutawayPlan& plan) {
    Tissue(mesh, scene, plan).draw();
}

void draw_fixture(Mesh& mesh, const CutAway& cut, const CutawayPlan& plan) {
    if (!cut.fixture_present) return;
    const double u = plan.unit, y = std::floor(plan.y(cut.position_fixture_m));
    const bool pressed = cut.position_needle_m >= cut.position_fixture_m;
    const Ink glow = ink(kReddishPurple, pressed ? 0.7 : 0.45), line = ink(kWallLine);
    mesh.box_down({plan.block_left, y}, {plan.block_right, y + 22 * u}, glow, faded(glow, 0));
    mesh.box_down({plan.block_left, y - 7 * u}, {plan.block_right, y}, faded(glow, 0), faded(glow, 0.5));
    const double thick = std::max(2.0, std::round((pressed ? 4 : 3) * u));
    mesh.box_down({plan.block_left, y}, {plan.block_right, y + thick}, line, line);
}

}  // namespace thimble
