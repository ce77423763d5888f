#include <cmath>

#include <fmt/format.h>

#include "analysis/figures/cell_map.hpp"
#include "common/math/portable.hpp"
#include "master/operator/limb.hpp"
#include "stability/critical_delay.hpp"
#include "stability/loop_measures.hpp"
#include "stability/perceptual_loop.hpp"
#include "stability/stability_map.hpp"
#include "study/compensators/compensator_report.hpp"
#include "study/loop_limits.hpp"
#include "study/study.hpp"
#include "study/worker_pool.hpp"

namespace thimble {
namespace {

constexpr double kPaperLoop_N_per_m = 9000;  // 3 x 1 x 3000 N/m
constexpr std::size_t kMapPoints = 40;
constexpr double kPaperDelay_s = 0.05;

MapPlan map_plan() {
    MapPlan plan;
    plan.hand = kTypicalHands[3].hand;
    plan.delays_s.reserve(kMapPoints);
    plan.stiffness_N_per_m.reserve(kMapPoints);
    for (std::size_t i = 0; i < kMapPoints; ++i) {
        const double part = static_cast<double>(i) / (kMapPoints - 1);
        plan.delays_s.push_back(0.2 * part);
        plan.stiffness_N_per_m.push_back(50 * portable::pow(400, part));
    }
    return plan;
}

std::vector<std::vector<MapCell>> map_columns(const MapPlan& plan, unsigned jobs) {
    using Column = std::vector<MapCell>;
    std::vector<Column> columns;
    columns.reserve(plan.delays_s.size());
    run_in_order<Column>(
        plan.delays_s.size(), jobs, nullptr, [&](std::size_t i) { return map_column(plan, i); },
        [&](Column column) { columns.push_back(std::move(column)); });
    return columns;
}

FigureSource loop_map_figure(const MapPlan& plan, const std::vector<std::vector<MapCell>>& columns) {
    CellMap map{"round-trip delay (ms)",
                "contact stiffness at the handle (N/m)",
                {},
                plan.stiffness_N_per_m,
                true,
                outcome_classes(),
                {{"", {}, {}}},
                1,
                "theory",
                {{kPaperLoop_N_per_m, "the paper's fixture"}}};
    for (const std::vector<MapCell>& column : columns) {
        map.x.push_back(1000 * column.front().delay_s);
        map.panels[0].curve.push_back(column.front().critical_stiffness_N_per_m);
        for (const MapCell& cell : column) map.panels[0].labels.push_back(static_cast<char>(cell.hold.label));
    }
    FigureSource figure = cell_map_figure(map, "compensators_map");
    figure.title = "Delay against stiffness";
    figure.caption =
        "A firm grip (D) keeps contact with the fixture for 12 s: outcome in each cell, and the stability "
        "boundary of the sampled loop by theory. Dashed line: the paper's fixture.";
    return figure;
}

ReportTable critical_delay_table() {
    ReportTable table{
        "Critical delay at the paper's fixture, 9000 N/m at the handle",
        "Theory: closed form. Measured: the simulated loop at 10 kHz, by bisection, plus half a sampling "
        "period. No hand is stable at the paper's 50 ms.",
        {"hand (kg, Ns/m, N/m)", "theory (ms)", "measured (ms)", "difference (us)", "50 ms is longer by"}};
    for (const TypicalHand& typical : kTypicalHands) {
        const HeldMass& h = typical.hand;
        const double theory_s = critical_delay_s(h, kPaperLoop_N_per_m),
                     measured_s = measured_critical_delay_s(h, kPaperLoop_N_per_m);
        table.rows.push_back(
            {fmt::format("{} ({}, {}, {})", typical.name, h.mass_kg, h.damping_Ns_per_m, h.stiffness_N_per_m),
             fmt::format("{:.4f}", 1000 * theory_s), fmt::format("{:.4f}", 1000 * measured_s),
             fmt::format("{:+.2f}", 1e6 * (measured_s - theory_s)),
             fmt::format("{:.0f} times", kPaperDelay_s / theory_s)});
    }
    return table;
}

// Nominal arm and hand as one mass.
HeldMass lumped(const SystemSettings& settings) {
    const HeldHandle held = held_handle(settings);
    return {held.handle_mass_kg + held.arm_mass_kg, held.handle_damping_Ns_per_m + held.arm_damping_Ns_per_m,
            held.arm_stiffness_N_per_m};
}

double operator_limit_per_s(const SystemSettings& settings, double lag_s) {
    double stable = 0, unstable = 6 / lag_s;
    while (unstable - stable > 1e-3 * unstable) {
        const double middle = (stable + unstable) / 2;
        (operator_growth_per_s(settings, lag_s, middle) > 0 ? unstable : stable) = middle;
    }
    return (stable + unstable) / 2;
}

// Skin's device and the paper's delay; the reaction comes on top.
double device_lag_s(const SystemSettings& settings) {
    return to_seconds(settings.cutaneous.dead_time + settings.cutaneous.time_constant) + kPaperDelay_s;
}

FigureSource perceptual_figure(const SystemSettings& settings) {
    constexpr int kReactions = 16, kGains = 16;
    CellMap map{"reaction time (ms)",
                "gain of the correction (1/s)",
                {},
                {},
                false,
                {{'S', kSkyBlue, "dies out"}, {'O', kVermillion, "oscillates"}},
                {{"", {}, {}}},
                1,
                "theory, hand and arm as one mass",
                {}};
    for (int j = 0; j < kGains; ++j) map.y.push_back(1 + 0.75 * j);
    for (int i = 0; i < kReactions; ++i) {
        const double reaction_s = 0.05 + 0.025 * i, lag_s = device_lag_s(settings) + reaction_s;
        map.x.push_back(1000 * reaction_s);
        map.panels[0].curve.push_back(perceptual_limit(lumped(settings), lag_s).gain_per_s);
        for (const double gain_per_s : map.y)
            map.panels[0].labels.push_back(operator_growth_per_s(settings, lag_s, gain_per_s) > 0 ? 'O'
                                                                                                  : 'S');
    }
    FigureSource figure = cell_map_figure(map, "compensators_perceptual");
    figure.title = "The loop of a person who corrects";
    figure.caption =
        "The arm of the virtual operator, which corrects without pauses by what the skin feels. The lag is "
        "the reaction time plus the lag of the device and 50 ms of network delay.";
    return figure;
}

ReportTable perceptual_table() {
    ReportTable table{
        "Critical gain of corrections by skin or eyes",
        "Lag: delay, device and reaction time together. Corrections without pauses: x_d' = -L x(t - lag), "
        "with the gain L in 1/s. A person who presses on the paper's fixture corrects by L / 9000 m/s per N.",
        {"hand", "lag (ms)", "theory (1/s)", "measured (1/s)", "difference (%)"}};
    for (const TypicalHand& typical : kTypicalHands) {
        for (const double lag_s : {0.195, 0.245, 0.395}) {
            const double theory = perceptual_limit(typical.hand, lag_s).gain_per_s;
            const double measured = measured_perceptual_limit_per_s(typical.hand, lag_s, 1e-4);
            table.rows.push_back({typical.name, fmt::format("{:.0f}", 1000 * lag_s),
                                  fmt::format("{:.3f}", theory), fmt::format("{:.3f}", measured),
                                  fmt::format("{:+.2f}", 100 * (measured / theory - 1))});
        }
    }
    return table;
}

// Of the settings' virtual operator in each modality: lag, limit without pauses, and with the pauses of an intermittent person.
ReportTable operator_table(const SystemSettings& settings) {
    const BehaviourParameters& behaviour = settings.person.behaviour;
    const LoopLimits limits = loop_limits(settings);
    ReportTable table;
    table.title = "Lags and critical gains of the virtual operator";
    const double period_s = behaviour.refractory_s + behaviour.relax_s;
    table.note = fmt::format(
        "Without pauses: the same arm, moved by x_d' = -L x(t - lag). The operator's feed-forward of speed "
        "makes its critical gain a little higher than that of one mass on a spring. With pauses: a move of "
        "{:.0f} ms every {:.0f} ms (refractory period and move); the table shows the part of the error that "
        "a move may correct. The built-in operator moves with pauses, and only forward or to rest. It never "
        "moves back from a stop that is too deep, so its own loop cannot oscillate.",
        1000 * behaviour.relax_s, 1000 * period_s);
    table.columns = {"modality",
                     "delay (ms)",
                     "lag (ms)",
                     "theory, one mass (1/s)",
                     "measured, the operator's arm (1/s)",
                     "with pauses, part of the error"};
    for (const Modality modality : {Modality::kCF, Modality::kCCF, Modality::kVF}) {
        for (const double delay_s : {0.0, 0.05, 0.2}) {
            const double lag_s = limits.latency_s[static_cast<std::size_t>(modality)] + delay_s;
            table.rows.push_back({to_string(modality), fmt::format("{:.0f}", 1000 * delay_s),
                                  fmt::format("{:.0f}", 1000 * lag_s),
                                  fmt::format("{:.2f}", perceptual_limit(lumped(settings), lag_s).gain_per_s),
                                  fmt::format("{:.2f}", operator_limit_per_s(settings, lag_s)),
                                  fmt::format("{:.2f}", paused_limit({lag_s, period_s, behaviour.relax_s}))});
        }
    }
    return table;
}

}  // namespace

double operator_growth_per_s(const SystemSettings& settings, double lag_s, double gain_per_s) {
    constexpr double kLet_go_m = 1e-3, kWatchedLags = 60, kTick_s = 1e-3;
    HandleMechanics handle = settings.handle.mechanics;
    handle.friction_N = 0;
    HandMechanics hand = settings.person.hand;
    Limb limb(handle, hand);
    limb.reset(hand.arm_stiffness_N_per_m, hand.grip_stiffness_N_per_m);
    const auto lag_ticks = static_cast<std::size_t>(std::lround(lag_s / kTick_s));
    const auto ticks = static_cast<std::size_t>(kWatchedLags * lag_s / kTick_s);
    const unsigned steps = static_cast<unsigned>(std::chrono::milliseconds{1} / Limb::kStep);
    std::vector<double> trace;
    trace.reserve(ticks);
    // From the equilibrium: what is perceived until the first lag is over is an error of 1 mm.
    double intention_m = 0;
    for (std::size_t i = 0; i < ticks; ++i) {
        trace.push_back(limb.position_hand_m());
        const double perceived_m = i < lag_ticks ? kLet_go_m : trace[i - lag_ticks];
        const double speed_m_per_s = -gain_per_s * perceived_m;
        intention_m += speed_m_per_s * kTick_s;
        limb.command({intention_m, speed_m_per_s, 1});
        limb.advance(steps, 0);
        if (!(std::abs(limb.position_hand_m()) < 1e6)) break;
    }
    const std::span<const double> all(trace);
    return portable::log(growth_per_sample(all.subspan(all.size() / 2))) / kTick_s;
}

ReportSection handle_loop_section(const std::filesystem::path& out, unsigned jobs) {
    const MapPlan plan = map_plan();
    const auto columns = map_columns(plan, jobs);
    std::size_t cells = 0, wrong = 0;
    for (const std::vector<MapCell>& column : columns) {
        for (const MapCell& cell : column) {
            const double away =
                std::abs(portable::log(cell.stiffness_N_per_m / cell.critical_stiffness_N_per_m));
            const bool should_grow = cell.stiffness_N_per_m > cell.critical_stiffness_N_per_m;
            if (cell.growth == GrowthClass::kMarginal || away < 0.02) continue;
            ++cells;
            wrong += (cell.growth == GrowthClass::kUnstable) != should_grow ? 1 : 0;
        }
    }
    ReportSection section;
    section.title = "The handle's loop: theory and measurement";
    section.text = fmt::format(
        "A delayed force drives the hand. {} cells of the map are farther than 2 % from the boundary. In {} "
        "of them the movement grows or decays against the theory.",
        cells, wrong);
    section.drawn = draw_figures({loop_map_figure(plan, columns)}, out);
    section.tables = {critical_delay_table()};
    return section;
}

ReportSection perceptual_loop_section(const SystemSettings& settings, const std::filesystem::path& out) {
    ReportSection section;
    section.title = "The person's loop: fingertips and eyes";
    section.text =
        "In CF, CCF and VF no force acts on the handle, at any delay. One loop remains: the person corrects "
        "by what was felt or seen one lag ago. Above a critical gain, which falls with delay and reaction "
        "time, this loop oscillates, too.";
    section.drawn = draw_figures({perceptual_figure(settings)}, out);
    section.tables = {operator_table(settings), perceptual_table()};
    return section;
}

}  // namespace thimble
