#include "study/maps/map_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/control/control_settings.hpp"
#include "common/error.hpp"
#include "common/math/portable.hpp"
#include "common/messages.hpp"
#include "session/settings/system_settings.hpp"
#include "stability/critical_delay.hpp"
#include "stability/delayed_loop.hpp"
#include "study/planned_table.hpp"

namespace thimble {
namespace {

constexpr long kMostPoints = 10000;
constexpr double kMostCells = 1e8;

[[noreturn]] void refuse_axis(const std::string& option, const std::string& text) {
    throw Error(
        ExitCode::kUsage,
        fmt::format(
            "{} {}: needs LOW:HIGH:POINTS with LOW < HIGH and 2 to 10000 points, or values like 0,0.05",
            option, text));
}

std::vector<double> spread(double low, double high, long points, bool logarithmic) {
    std::vector<double> values;
    values.reserve(static_cast<std::size_t>(points));
    for (long i = 0; i < points; ++i) {
        const double part = static_cast<double>(i) / static_cast<double>(points - 1);
        values.push_back(logarithmic ? low * portable::pow(high / low, part) : low + (high - low) * part);
    }
    return values;
}

void require(bool good, const char* why) {
    if (!good) throw Error(ExitCode::kUsage, fmt::format("sweep: {}", why));
}

bool all_within(const std::vector<double>& values, double low, double high) {
    return !values.empty() &&
           std::all_of(values.begin(), values.end(), [&](double v) { return v >= low && v <= high; });
}

bool known_compensator(const MapGrid& grid, const std::string& name) {
    if (std::find(kBuiltInCompensators.begin(), kBuiltInCompensators.end(), name) !=
        kBuiltInCompensators.end())
        return true;
    if (name == kCompensatorNames.back())
        return !grid.config.empty() &&
               load_system_settings(grid.config).master.control.compensator == Compensator::kPlugin;
    const auto same = [&](Modality modality) { return name == to_string(modality); };
    return grid.who == MapOperator::kVirtual && std::any_of(kModalities.begin(), kModalities.end(), same);
}

std::string unknown_text(const MapGrid& grid, const std::string& name) {
    return fmt::format(
        "--compensators {}: choose from {}{}, or plugin with a session whose [control] names one", name,
        fmt::join(kBuiltInCompensators, ", "), grid.who == MapOperator::kVirtual ? ", CF, CCF, VF" : "");
}

}  // namespace

NamedHand named_hand(std::string_view letter) {
    for (const TypicalHand& typical : kTypicalHands) {
        if (letter == std::string_view(typical.name, 1)) return {std::string(letter), typical.hand};
    }
    throw Error(ExitCode::kUsage, fmt::format("--hand {}: choose from A, B, C, D and E", letter));
}

CellPlace place_of(const MapGrid& g, std::size_t cell) {
    const auto take = [&cell](std::size_t count) {
        const std::size_t index = cell % count;
        cell /= count;
        return index;
    };
    CellPlace place{};
    place.stiffness = take(g.column());
    place.delay = take(g.delays_s.size());
    place.loss = take(g.losses.size());
    place.jitter = take(g.jitters_s.size());
    place.compensator = take(g.compensators.size());
    place.hand = take(g.hands.size());
    return place;
}

std::vector<double> parse_map_axis(const std::string& option, const std::string& text, bool logarithmic) {
    double low = 0, high = 0;
    long points = 0;
    char end = 0;
    if (std::sscanf(text.c_str(), "%lf:%lf:%ld%c", &low, &high, &points, &end) == 3) {
        const bool good = std::isfinite(low) && std::isfinite(high) && high > low && points >= 2 &&
                          points <= kMostPoints && !(logarithmic && low <= 0);
        if (!good) refuse_axis(option, text);
        return spread(low, high, points, logarithmic);
    }
    std::vector<double> values;
    values.reserve(text.size());
    const char* at = text.c_str();
    for (;;) {
        char* after = nullptr;
        values.push_back(std::strtod(at, &after));
        if (after == at || !std::isfinite(values.back())) refuse_axis(option, text);
        if (*after == '\0') return values;
        if (*after != ',') refuse_axis(option, text);
        at = after + 1;
    }
}

void require_meaningful(const MapGrid& g) {
    for (const NamedHand& hand : g.hands) require_meaningful(hand.hand);
    require(all_within(g.delays_s, 0, 1e3), "each --delay-s must be 0 to 1000 s");
    require(all_within(g.stiffness_N_per_m, 1e-9, 1e12),
            "each --contact-stiffness-N-per-m or --gain must be above 0");
    require(all_within(g.jitters_s, 0, 1e3), "each --jitter-s must be 0 to 1000 s");
    require(all_within(g.losses, 0, g.mean_burst / (1 + g.mean_burst)),
            "each --loss must be 0 to 0.5 (with --loss-burst B up to B / (1 + B))");
    require(std::isfinite(g.press_N + g.force_limit_N + g.encoder_step_m + g.friction_N + g.mean_burst),
            "--press-N, --force-limit-N, --encoder-m, --friction-N and --loss-burst must be finite");
    require(!g.hands.empty() && !g.compensators.empty(),
            "--hand and --compensators need at least one name each");
    require(static_cast<double>(g.panels()) * static_cast<double>(g.panel()) <= kMostCells,
            "the map has more than 1e8 cells: give fewer points");
    for (const std::string& name : g.compensators) {
        require(known_compensator(g, name), unknown_text(g, name).c_str());
    }
}

std::string grid_text(const MapGrid& g) {
    std::string text = fmt::format("operator {}\n", g.who == MapOperator::kVirtual ? "virtual" : "passive");
    for (const NamedHand& h : g.hands)
        text += fmt::format("hand {}: {} kg {} Ns/m {} N/m\n", h.name, h.hand.mass_kg,
                            h.hand.damping_Ns_per_m, h.hand.stiffness_N_per_m);
    text += fmt::format(
        "compensator {}\njitter_s {}\nloss {}, in bursts of {}\ndelay_s {}\nstiffness_N_per_m {}, gain 1 is "
        "{}\n",
        fmt::join(g.compensators, " "), fmt::join(g.jitters_s, " "), fmt::join(g.losses, " "), g.mean_burst,
        fmt::join(g.delays_s, " "), fmt::join(g.stiffness_N_per_m, " "), g.full_stiffness_N_per_m);
    if (g.who == MapOperator::kPassive)
        text += fmt::format("step {} s, press {} N, limit {} N, encoder {} m, friction {} N\n", g.step_s,
                            g.press_N, g.force_limit_N, g.encoder_step_m, g.friction_N);
    text += fmt::format("seed {}, trials {}\n", g.seed, g.trials);
    if (g.config.empty()) return text;
    return text + session_text(load_system_settings(g.config));
}

}  // namespace thimble
