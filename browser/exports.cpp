// Functions for the page's JavaScript. Only numbers and texts pass.
#include <array>
#include <cmath>
#include <emscripten.h>
#include <string>
#include <utility>

#include "browser/live_trial.hpp"
#include "browser/page_study.hpp"
#include "common/network_labels.hpp"
#include "netem/profiles/profiles.hpp"
#include "stability/critical_delay.hpp"
#include "study/loop_limits.hpp"
#include "visual_node/gamepad/rumble_pace.hpp"
#include "visual_node/window/cutaway.hpp"

namespace thimble {
namespace {

constexpr std::size_t kTrials = 4;  // one alone, two side by side, a recorded one

using Field = std::pair<const char*, double LiveState::*>;
constexpr std::array kFields{Field{"time_s", &LiveState::time_s},
                             Field{"needle_m", &LiveState::needle_m},
                             Field{"surface_m", &LiveState::surface_m},
                             Field{"fixture_m", &LiveState::fixture_m},
                             Field{"force_hand_N", &LiveState::force_hand_N},
                             Field{"force_finger_N", &LiveState::force_finger_N},
                             Field{"force_bar_N", &LiveState::force_bar_N},
                             Field{"force_total_N", &LiveState::force_total_N},
                             Field{"energy_in_J", &LiveState::energy_in_J},
                             Field{"contacts_lost", &LiveState::contacts_lost},
                             Field{"frequency_Hz", &LiveState::frequency_Hz},
                             Field{"hold_s", &LiveState::hold_s},
                             Field{"beeps", &LiveState::beeps},
                             Field{"trials", &LiveState::trials},
                             Field{"hand_m", &LiveState::hand_m},
                             Field{"delay_s", &LiveState::delay_s}};

struct Side {
    std::unique_ptr<LiveTrial> trial;  // null: a recorded one
    Scene recorded;
    std::array<double, kFields.size()> values{};
    std::optional<Scene> calm;  // the last one that was drawn
    RumblePace pace;
    std::array<double, 2> motors{};
    Mesh mesh;
    std::string labels;
};
std::array<Side, kTrials> sides;
Side& side_of(int number) { return sides.at(static_cast<std::size_t>(number)); }
std::unique_ptr<PageStudy> study;
std::string words;  // of the last text that was asked for

// Texts with their places, a line each: x, y, red, green, blue, 1 if it ends there, words.
std::string lines_of(const std::vector<CutawayLabel>& labels) {
    std::string lines;
    for (const CutawayLabel& label : labels) {
        lines += fmt::format("{:.1f} {:.1f} {} {} {} {:d} {}\n", label.at.x, label.at.y, label.colour[0],
                             label.colour[1], label.colour[2], label.ends_there, label.text);
    }
    return lines;
}

// Moves `scene` only by a share of its way from `before`, so that a trembling needle is drawn at rest.
void come_nearer(const Scene& before, double share, Scene& scene) {
    const auto near = [share](double from, double& to) { to = std::lerp(from, to, share); };
    near(before.position_surface_m, scene.position_surface_m);
    near(before.bar_N, scene.bar_N);
    near(before.fingertip_N, scene.fingertip_N);
    near(before.cut_away->position_needle_m, scene.cut_away->position_needle_m);
    near(before.cut_away->force_tissue_N, scene.cut_away->force_tissue_N);
    near(before.cut_away->force_fixture_N, scene.cut_away->force_fixture_N);
}

}  // namespace
}  // namespace thimble

using namespace thimble;

extern "C" {

EMSCRIPTEN_KEEPALIVE const char* state_names() {
    words.clear();
    for (const Field& field : kFields) words += std::string(words.empty() ? "" : " ") + field.first;
    return words.c_str();
}

EMSCRIPTEN_KEEPALIVE void begin_trial(int side, int modality, double delay_s, int virtual_hand,
                                      int compensator, int seed) {
    LiveChoice choice;
    choice.modality = kModalities.at(static_cast<std::size_t>(modality));
    choice.delay_s = delay_s;
    choice.virtual_hand = virtual_hand != 0;
    choice.compensator = static_cast<Compensator>(compensator);
    choice.seed = static_cast<std::uint64_t>(seed);
    side_of(side).trial = std::make_unique<LiveTrial>(choice);
    side_of(side).calm.reset();
}

EMSCRIPTEN_KEEPALIVE void change_delay(int side, double delay_s) {
    side_of(side).trial->change_delay(delay_s);
}

EMSCRIPTEN_KEEPALIVE int change_network(int side, const char* name) {
    return side_of(side).trial->change_network(name) ? 1 : 0;
}

// The state after it, in the order of state_names().
EMSCRIPTEN_KEEPALIVE const double* advance(int side, double seconds, double hand_m, int engaged) {
    Side& one = side_of(side);
    one.trial->point(hand_m, engaged != 0);
    one.trial->advance(seconds);
    const LiveState state = one.trial->state();
    for (std::size_t i = 0; i < kFields.size(); ++i) one.values[i] = state.*kFields[i].second;
    return one.values.data();
}

// Builds the cut-away view for a canvas of this size, in pixels. `share`: of the way from what was drawn last to what is now; 1 is all.
EMSCRIPTEN_KEEPALIVE void draw(int side, double width, double height, int fixture_seen, double share) {
    Side& one = side_of(side);
    Scene scene = one.trial ? one.trial->scene() : one.recorded;
    if (!scene.cut_away) return;
    if (one.calm && share < 1) come_nearer(*one.calm, share, scene);
    one.calm = scene;
    const CutawayPlan plan = plan_cutaway({0, 0, width, height});
    if (fixture_seen == 0) scene.cut_away->fixture_present = false;
    build_cutaway(scene, plan, one.mesh);
    one.labels = lines_of(cutaway_labels(scene, plan));
}
EMSCRIPTEN_KEEPALIVE double drawn_needle_m(int side) {
    const Side& one = side_of(side);
    return one.calm ? one.calm->cut_away->position_needle_m : 0;
}
// A sample of a recorded trial, for draw(). Without a known fixture `fixture_m` is NaN. `rest_m`: the first sample's surface.
EMSCRIPTEN_KEEPALIVE void show_sample(int side, double needle_m, double surface_m, double fixture_m,
                                      double tissue_N, double fixture_N, int phase, int modality,
                                      double rest_m) {
    CutAway cut;
    cut.position_needle_m = needle_m;
    cut.position_fixture_m = fixture_m;
    cut.force_tissue_N = tissue_N;
    cut.force_fixture_N = fixture_N;
    cut.phase = static_cast<TissuePhase>(phase);
    cut.modality = kModalities.at(static_cast<std::size_t>(modality));
    cut.fixture_present = std::isfinite(fixture_m);
    Scene& scene = side_of(side).recorded;
    scene.position_needle_m = needle_m;
    scene.position_surface_m = surface_m;
    scene.position_surface_rest_m = rest_m;
    scene.set_cut_away(cut, tissue_N + fixture_N);
}
// Levels of a gamepad's motors, 0 to 1, strong and weak; null if there is no new command.
EMSCRIPTEN_KEEPALIVE const double* rumble(int side, double now_s) {
    Side& one = side_of(side);
    const Scene scene = one.trial->scene();
    const auto levels = one.pace.next(SessionTime{from_seconds(now_s)}, scene.fingertip_N, scene.thumb_N);
    if (!levels) return nullptr;
    one.motors = {levels->strong / 65535.0, levels->weak / 65535.0};
    return one.motors.data();
}
EMSCRIPTEN_KEEPALIVE double rumble_lasts_s() { return to_seconds(kRumbleLasts); }
EMSCRIPTEN_KEEPALIVE double pixels_per_metre(double height) {
    return plan_cutaway({0, 0, height, height}).per_m;
}
EMSCRIPTEN_KEEPALIVE const void* vertices(int side) { return side_of(side).mesh.vertices().data(); }
EMSCRIPTEN_KEEPALIVE int vertex_bytes(int side) {
    return static_cast<int>(side_of(side).mesh.vertices().size() * sizeof(Mesh::Vertex));
}
EMSCRIPTEN_KEEPALIVE const void* indices(int side) { return side_of(side).mesh.indices().data(); }
EMSCRIPTEN_KEEPALIVE int index_count(int side) {
    return static_cast<int>(side_of(side).mesh.indices().size());
}
EMSCRIPTEN_KEEPALIVE const char* labels(int side) { return side_of(side).labels.c_str(); }

// From which one-way delay on HF oscillates under this pointer, by theory.
EMSCRIPTEN_KEEPALIVE double onset_s() {
    const SystemSettings settings = load_system_settings({});
    const HandleSettings& handle = settings.handle;
    const double stiffness = settings.master.force_scale * settings.master.position_scale *
                             fixture_stiffness_N_per_m(settings.slave);
    return critical_delay_s(HeldMass{handle.mechanics.moving_mass_kg,
                                     handle.mechanics.damping_Ns_per_m + handle.coupling.damping_Ns_per_m,
                                     handle.coupling.stiffness_N_per_m},
                            stiffness);
}

EMSCRIPTEN_KEEPALIVE void begin_study(double seed, int subjects) {
    study =
        std::make_unique<PageStudy>(static_cast<std::uint64_t>(seed), static_cast<std::uint32_t>(subjects));
}
EMSCRIPTEN_KEEPALIVE int go_on_study(int instants) {
    return study->go_on(static_cast<unsigned>(instants)) ? 1 : 0;
}
EMSCRIPTEN_KEEPALIVE int study_planned() { return static_cast<int>(study->planned()); }
EMSCRIPTEN_KEEPALIVE int study_done() { return static_cast<int>(study->rows().size()); }
EMSCRIPTEN_KEEPALIVE double study_simulated_s() { return study->simulated_s(); }
// Of a row: modality, mean and maximum penetration (m), completion time (s), whether it oscillates, subject.
EMSCRIPTEN_KEEPALIVE double study_value(int row, int column) {
    const TrialRow& r = study->rows().at(static_cast<std::size_t>(row));
    const TrialMetrics& m = r.metrics;
    const std::array values{static_cast<double>(r.conditions.modality),
                            m.penetration_mean_m,
                            m.penetration_max_m,
                            m.completion_time_s,
                            m.oscillates ? 1.0 : 0.0,
                            static_cast<double>(r.conditions.subject)};
    return values.at(static_cast<std::size_t>(column));
}
EMSCRIPTEN_KEEPALIVE void write_study(const char* path) { study->write_table(path); }

// Name and plain words, a line each.
EMSCRIPTEN_KEEPALIVE const char* networks() {
    words.clear();
    for (const std::string_view name : profile_names())
        words += fmt::format("{}\t{}\n", name, network_label(name));
    return words.c_str();
}
EMSCRIPTEN_KEEPALIVE const char* compensators() {
    words.clear();
    for (const std::string_view name : kBuiltInCompensators) words += fmt::format("{}\n", name);
    return words.c_str();
}
}
