// thimble stability: what theory says about a hand at a delayed fixture.
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/shared_values.hpp"
#include "stability/limit_cycle.hpp"
#include "stability/sampled_loop.hpp"
#include "thimble/commands/commands.hpp"

namespace thimble {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostListed = 64;

struct StabilityArguments {
    DelayedLoop loop;
    std::optional<double> delay_s, step_s, press_N, lag_s;
    double force_limit_N = kHandleFullScale_N, encoder_m = 0, friction_N = 0;
    bool json = false;
};

// Infinite and missing numbers are null.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json given(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json crossings_of(const StabilityArguments& a, double critical_s) {
    // Four times the delay in question, so that one sees where it stands.
    const double longest_s = 4 * std::max(a.delay_s.value_or(0), critical_s);
    Json list = Json::array();
    if (!std::isfinite(longest_s)) return list;
    for (const RootCrossing& c : crossings(a.loop, longest_s, kMostListed)) {
        list.push_back({{"delay_s", c.delay_s},
                        {"frequency_rad_per_s", c.frequency_rad_per_s},
                        {"direction", c.direction},
                        {"unstable_roots_after", c.unstable_roots_after}});
    }
    return list;
}

Json stable_delays_of(const DelayedLoop& loop) {
    Json list = Json::array();
    for (const StableDelays& d : stable_delays(loop, kMostListed)) {
        list.push_back({{"from_s", d.from_s}, {"to_s", number(d.to_s)}});
    }
    return list;
}

void add_delay_free(const StabilityArguments& a, Json& all) {
    const CriticalPoint point = critical_point(a.loop);
    const bool critical = std::isfinite(point.delay_s);
    all["critical_delay_s"] = number(point.delay_s);
    all["crossing_frequency_rad_per_s"] = critical ? Json(point.frequency_rad_per_s) : Json(nullptr);
    all["stable_for_every_delay"] = !critical;
    all["delay_independent_stiffness_N_per_m"] = delay_independent_stiffness_N_per_m(a.loop.hand);
    all["crossings"] = crossings_of(a, point.delay_s);
    all["stable_delays"] = stable_delays_of(a.loop);
}

// Entries that are null until they are known.
void add_unknown(Json& all, std::initializer_list<const char*> names) {
    for (const char* name : names) all[name] = nullptr;
}

void add_at_delay(const StabilityArguments& a, Json& all) {
    add_unknown(all,
                {"unstable_roots", "stable", "rightmost_root_real_per_s", "rightmost_root_imag_rad_per_s",
                 "critical_stiffness_N_per_m", "critical_stiffness_frequency_rad_per_s"});
    if (!a.delay_s) return;
    const int roots = unstable_roots(a.loop, *a.delay_s);
    const DominantRoot root = rightmost_root(a.loop, *a.delay_s);
    const CriticalStiffness critical = critical_stiffness(a.loop.hand, *a.delay_s);
    all["unstable_roots"] = roots;
    all["stable"] = roots == 0 && root.real_per_s < 0;
    all["rightmost_root_real_per_s"] = root.real_per_s;
    all["rightmost_root_imag_rad_per_s"] = root.imaginary_rad_per_s;
    all["critical_stiffness_N_per_m"] = number(critical.stiffness_N_per_m);
    if (*a.delay_s > 0) all["critical_stiffness_frequency_rad_per_s"] = critical.frequency_rad_per_s;
}

void add_sampled(const StabilityArguments& a, Json& all) {
    add_unknown(all, {"spectral_radius", "sampled_growth_per_s", "sampled_stable",
                      "sampled_critical_stiffness_N_per_m", "passive_stiffness_N_per_m", "critical_samples",
                      "sampled_stable_for_every_delay"});
    if (!a.step_s) return;
    SampledLoop loop{a.loop.hand, a.loop.stiffness_N_per_m, 0, *a.step_s};
    const auto steps = critical_steps(loop);
    if (steps) all["critical_samples"] = steps->steps;
    all["sampled_stable_for_every_delay"] = !steps && growing_modes(loop) == 0;
    if (!a.delay_s) return;
    loop.delay_s = *a.delay_s;
    const DominantMode mode = dominant_mode(loop);
    all["spectral_radius"] = mode.radius;
    all["sampled_growth_per_s"] = mode.growth_per_s;
    all["sampled_stable"] = mode.radius < 1;
    all["sampled_critical_stiffness_N_per_m"] = critical_sampled_stiffness(loop).stiffness_N_per_m;
    all["passive_stiffness_N_per_m"] = passive_stiffness_N_per_m(loop);
}

Json cycle_of(const PressForecast& forecast) {
    if (!forecast.cycle) return nullptr;
    const LimitCycle& c = *forecast.cycle;
    return {{"predictor",
             forecast.predictor == CyclePredictor::kRelayOrbit ? "relay orbit" : "describing function"},
            {"amplitude_m", c.amplitude_m},
            {"frequency_rad_per_s", c.frequency_rad_per_s},
            {"lowest_m", c.lowest_m},
            {"highest_m", c.highest_m},
            {"contact_lost", c.lowest_m < 0}};
}

// With all of the delay: a hold is half a step more.
void add_press(const StabilityArguments& a, Json& all) {
    if (!a.delay_s || !(a.loop.hand.stiffness_N_per_m > 0)) return;
    const double whole_s = *a.delay_s + (a.step_s.value_or(0) / 2);
    const double press_N = a.press_N.value_or(a.force_limit_N / 2);
    const PressForecast forecast =
        forecast_press({a.loop.hand, a.loop.stiffness_N_per_m, whole_s, a.force_limit_N, press_N});
    const double critical = critical_stiffness(a.loop.hand, whole_s).stiffness_N_per_m;
    const bool rubs = a.friction_N > 0;
    const double least_m = rubs ? friction_threshold_m(a.loop, whole_s, a.friction_N) : 0;
    const double chatter_m = encoder_chatter_m(a.loop.stiffness_N_per_m, critical, a.encoder_m, a.friction_N);
    const auto fold_N = press_fold_N({a.loop.hand, a.loop.stiffness_N_per_m, whole_s, a.force_limit_N, 0});
    all["press"] = {{"press_N", press_N},
                    {"force_limit_N", a.force_limit_N},
                    {"delay_with_hold_s", whole_s},
                    {"rest_m", forecast.rest_m},
                    {"rest_is_stable", forecast.rest_is_stable},
                    {"pushed_through", forecast.pushed_through},
                    {"limit_cycle", cycle_of(forecast)},
                    {"fold_N", fold_N ? number(*fold_N) : Json(nullptr)},
                    {"friction_threshold_m", rubs ? number(least_m) : Json(nullptr)},
                    {"encoder_chatter_m", number(chatter_m)}};
}

void add_perception(const StabilityArguments& a, Json& all) {
    if (!a.lag_s) return;
    const PerceptualLimit limit = perceptual_limit(a.loop.hand, *a.lag_s);
    all["perceptual_loop"] = {{"lag_s", *a.lag_s},
                              {"critical_gain_per_s", limit.gain_per_s},
                              {"critical_gain_m_per_s_per_N", limit.gain_per_s / a.loop.stiffness_N_per_m},
                              {"frequency_rad_per_s", limit.frequency_rad_per_s}};
}

std::string shown(const Json& value) {
    if (value.is_null()) return "-";
    if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
    if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
    return value.is_string() ? value.get<std::string>() : json_text(value);
}

void print_rows(const Json& table, const std::string& indent) {
    for (const auto& [name, value] : table.items()) {
        if (value.is_object()) {
            fmt::print("{}{}\n", indent, name);
            print_rows(value, indent + "  ");
        } else if (value.is_array()) {
            fmt::print("{}{}{}\n", indent, name, value.empty() ? " none" : "");
            for (const Json& row : value) {
                std::string line;
                for (const auto& [key, cell] : row.items()) line += fmt::format("  {} {}", key, shown(cell));
                fmt::print("{}{}\n", indent, line);
            }
        } else {
            fmt::print("{}{:<42}{}\n", indent, name, shown(value));
        }
    }
}

int run_stability(const StabilityArguments& a) {
    if (a.delay_s) require_delay(*a.delay_s);
    if (!std::isfinite(a.encoder_m + a.friction_N + a.force_limit_N)) {
        throw Error(ExitCode::kUsage, "--encoder-m, --friction-N and --force-limit-N must be finite numbers");
    }
    Json all{{"mass_kg", a.loop.hand.mass_kg},
             {"damping_Ns_per_m", a.loop.hand.damping_Ns_per_m},
             {"stiffness_N_per_m", a.loop.hand.stiffness_N_per_m},
             {"contact_stiffness_N_per_m", a.loop.stiffness_N_per_m},
             {"delay_s", given(a.delay_s)},
             {"step_s", given(a.step_s)}};
    add_delay_free(a, all);
    add_at_delay(a, all);
    add_sampled(a, all);
    add_press(a, all);
    add_perception(a, all);
    if (a.json) {
        fmt::print("{}\n", json_text(all, 2));
    } else {
        print_rows(all, "");
    }
    return static_cast<int>(ExitCode::kOk);
}

void add_loop_options(CLI::App& command, StabilityArguments& a) {
    command.add_option("--mass-kg", a.loop.hand.mass_kg, "mass of hand and handle together, kg")->required();
    command
        .add_option("--damping-Ns-per-m", a.loop.hand.damping_Ns_per_m, "damping of hand and handle, Ns/m")
        ->required();
    command.add_option("--stiffness-N-per-m", a.loop.hand.stiffness_N_per_m, "stiffness of the hand, N/m")
        ->required();
    command
        .add_option("--contact-stiffness-N-per-m", a.loop.stiffness_N_per_m,
                    "stiffness of the fixture at the handle, N/m: position scale x force scale x stiffness "
                    "at the needle")
        ->required();
    command.add_option("--delay-s", a.delay_s, "round-trip delay to examine, s");
    command.add_option("--step-s", a.step_s, "sampling period, s; a force is held for one period");
}

void add_press_options(CLI::App& command, StabilityArguments& a) {
    const auto not_negative = CLI::NonNegativeNumber;
    command
        .add_option("--press-N", a.press_N,
                    "force with which the hand presses on the fixture, N (default: half of --force-limit-N)")
        ->check(not_negative);
    command.add_option("--force-limit-N", a.force_limit_N, "force limit of the handle, N")
        ->default_val(12)
        ->check(CLI::PositiveNumber);
    command.add_option("--encoder-m", a.encoder_m, "resolution of the handle's encoder, m (default: 0)")
        ->check(not_negative);
    command.add_option("--friction-N", a.friction_N, "dry friction of the handle, N (default: 0)")
        ->check(not_negative);
    command.add_option("--perception-lag-s", a.lag_s,
                       "lag of a person who corrects by fingertips or eyes, s: delay, device and reaction "
                       "time together. The "
                       "command then computes the gain at which this person oscillates");
    command.add_flag("--json", a.json,
                     "print JSON on stdout, instead of a table; null: infinite, or not computed");
}

}  // namespace

Subcommand add_stability(CLI::App& app) {
    const auto arguments = std::make_shared<StabilityArguments>();
    CLI::App* command =
        app.add_subcommand("stability", "compute the critical delay and stiffness of a hand, by theory");
    add_loop_options(*command, *arguments);
    add_press_options(*command, *arguments);
    command->footer(
        "Example, a firm grip at the paper's fixture and delay:\n"
        "  thimble stability --mass-kg 1 --damping-Ns-per-m 20 --stiffness-N-per-m 500 \\\n"
        "      --contact-stiffness-N-per-m 9000 --delay-s 0.05 --step-s 0.001 --press-N 5\n"
        "Results at a delay need --delay-s, results of the sampled loop --step-s.\n"
        "Manual, with the equations: docs/stability.md");
    return {command, [arguments] { return run_stability(*arguments); }};
}

}  // namespace thimble
