// A cell with the passive hand, and the row of any.
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/process/isolated.hpp"
#include "session/settings/system_settings.hpp"
#include "stability/stability_map.hpp"
#include "study/maps/cells.hpp"
#include "study/maps/compensated_loop.hpp"

namespace thimble {
namespace {

constexpr double kShareMargin = 0.8;
constexpr std::size_t kMeasures = 15;  // columns that a cell's measures have

LoopConditions conditions_of(const MapGrid& g, const CellPlace& place) {
    LoopConditions c;
    c.loop = {g.hands[place.hand].hand, g.stiffness_N_per_m[place.stiffness], g.delays_s[place.delay],
              g.step_s};
    c.one_sided = true;
    c.force_limit_N = g.force_limit_N;
    c.press_N = g.press_N;
    c.encoder_step_m = g.encoder_step_m;
    c.friction_N = g.friction_N;
    return c;
}

Compensator compensator_named(const std::string& name) {
    std::size_t i = 0;
    while (i + 1 < kCompensatorNames.size() && kCompensatorNames[i] != name) ++i;
    return static_cast<Compensator>(i);
}

// The largest share of this stiffness that is stable with the longest delay, times a margin; 1 if all of it is.
double stable_share_of(const CompensatedConditions& c, double critical_N_per_m) {
    SampledLoop longest = c.loop.loop;
    longest.delay_s += c.jitter_s;
    if (c.jitter_s > 0) critical_N_per_m = critical_sampled_stiffness(longest).stiffness_N_per_m;
    const double stable = critical_N_per_m / longest.stiffness_N_per_m;
    return stable > 1 ? 1 : kShareMargin * stable;
}

struct HeldCell {
    HoldOutcome hold;
    double effective_delay_s = std::numeric_limits<double>::quiet_NaN();
};

HeldCell held(const CompensatedConditions& conditions) {
    const HoldPlan plan;
    CompensatedLoop run(conditions, plan.start_m, plan.start_m_per_s);
    const HoldOutcome hold = watched_hold(run, plan, conditions.loop.loop.step_s);
    return {hold, run.effective_delay_s()};
}

std::string growth_fields(const LoopConditions& conditions) {
    const double growth_per_s = measured_growth_per_s(conditions.loop, 0);
    return fmt::format("{:.6g},{}", growth_per_s, name_of(growth_class(growth_per_s)));
}

std::string number_or_nothing(double value, const char* format) {
    return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "";
}

std::string measures_of(const MapGrid& grid, const CellPlace& place, const ControlSettings& control,
                        double critical_N_per_m) {
    CompensatedConditions c;
    c.loop = conditions_of(grid, place);
    c.control = control;
    c.control.compensator = compensator_named(grid.compensators[place.compensator]);
    c.jitter_s = grid.jitters_s[place.jitter];
    c.loss = grid.losses[place.loss];
    c.mean_burst = grid.mean_burst;
    c.seed = grid.seed;
    if (c.control.compensator == Compensator::kScaled) c.control.share = stable_share_of(c, critical_N_per_m);
    const bool plain = c.control.compensator == Compensator::kNone && c.jitter_s == 0 && c.loss == 0;
    const HeldCell cell =
        plain ? HeldCell{measured_hold(c.loop, {}), c.loop.loop.delay_s + grid.step_s / 2} : held(c);
    const HoldOutcome& h = cell.hold;
    return fmt::format("{},{},{},{:.6g},{:.4g},{:.6g},{},{:.6g},,,,,,", plain ? growth_fields(c.loop) : ",",
                       static_cast<char>(h.label), h.energy_grows ? "yes" : "no", h.peak_to_peak_m,
                       h.losses_per_s, h.energy_J, number_or_nothing(cell.effective_delay_s, "{:.6g}"),
                       c.control.hand_share());
}

}  // namespace

double passive_critical_N_per_m(const MapGrid& grid, const CellPlace& place) {
    return critical_sampled_stiffness(conditions_of(grid, place).loop).stiffness_N_per_m;
}

std::string passive_measures(const MapGrid& grid, const CellPlace& place, double critical_N_per_m) {
    if (compensator_named(grid.compensators[place.compensator]) != Compensator::kPlugin)
        return measures_of(grid, place, {}, critical_N_per_m);
    const ControlSettings plugin = load_system_settings(grid.config).master.control;
    const IsolatedResult apart =
        run_isolated([&] { return measures_of(grid, place, plugin, critical_N_per_m); });
    if (apart.bytes) return *apart.bytes;
    spdlog::error("sweep: delay {:g} s: {}", grid.delays_s[place.delay], apart.failure);
    return std::string(kMeasures - 1, ',');
}

std::string cells_header() {
    return "hand,operator,remedy,jitter_s,loss,delay_s,gain,stiffness_N_per_m,critical_stiffness_N_per_m,"
           "growth_per_s,linear,outcome,energy_grows,peak_to_peak_m,losses_per_s,energy_J,effective_delay_s,"
           "hand_share,trials,completed,oscillating,penetration_mean_m,penetration_max_m,completion_time_s\n";
}

CellWriter::CellWriter(const MapGrid& grid)
    : grid_(grid), critical_N_per_m_(grid.hands.size() * grid.delays_s.size()) {}

double CellWriter::critical_N_per_m(const CellPlace& p) {
    std::optional<double>& known = critical_N_per_m_[p.hand * grid_.delays_s.size() + p.delay];
    {
        const std::lock_guard lock(mutex_);
        if (known) return *known;
    }
    const double critical = grid_.who == MapOperator::kVirtual ? virtual_critical_N_per_m(grid_, p)
                                                               : passive_critical_N_per_m(grid_, p);
    const std::lock_guard lock(mutex_);
    known = critical;
    return critical;
}

std::string CellWriter::rows(const CellRange& range) {
    const MapGrid& g = grid_;
    const bool person = g.who == MapOperator::kVirtual;
    std::string rows;
    for (std::size_t cell = range.first; cell < range.first + range.count; ++cell) {
        const CellPlace p = place_of(g, cell);
        const double stiffness = g.stiffness_N_per_m[p.stiffness], critical = critical_N_per_m(p);
        rows +=
            fmt::format("{},{},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{},", g.hands[p.hand].name,
                        person ? "virtual" : "passive", g.compensators[p.compensator], g.jitters_s[p.jitter],
                        g.losses[p.loss], g.delays_s[p.delay], stiffness / g.full_stiffness_N_per_m,
                        stiffness, number_or_nothing(critical, "{:.9g}"));
        rows += person ? virtual_measures(g, p) : passive_measures(g, p, critical);
        rows += '\n';
    }
    return rows;
}

}  // namespace thimble
