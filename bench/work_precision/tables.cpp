#include "bench/work_precision/tables.hpp"

#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "common/csv/csv.hpp"
#include "common/csv/csv_file.hpp"

namespace thimble {

namespace {

constexpr double kNone = Contestant::kNone;

std::string line_of(const Entry& e) {
    std::string line =
        fmt::format("{},{},{},", e.problem->name, to_string(e.problem->kind), e.contestant.solver);
    const auto out = std::back_inserter(line);
    const bool known = e.finished();
    const auto number = [&out, &line](double value) {
        write_number(out, value);
        line += ',';
    };
    number(e.contestant.step_s);
    number(e.contestant.tolerance);
    line += fmt::format("{},", to_string(e.outcome));
    number(known ? e.accuracy.position_m : kNone);
    number(known ? e.accuracy.velocity_m_per_s : kNone);
    number(known ? e.accuracy.force_N : kNone);
    number(known ? e.accuracy.event_time_s : kNone);
    line += known ? fmt::format("{},{},", e.accuracy.events, e.accuracy.events_reference) : ",,";
    number(known ? e.evaluations_per_ms : kNone);
    number(known ? e.cost.least_ns_per_ms : kNone);
    number(known ? e.cost.median_ns_per_ms : kNone);
    line += fmt::format("{}\n", e.cost.runs);
    return line;
}

std::string number_text(double value) { return std::isnan(value) ? "-" : fmt::format("{:.1e}", value); }

const Entry* exact_on(const std::vector<Entry>& entries, const Problem& problem) {
    for (const Entry& e : entries) {
        if (e.problem == &problem && e.contestant.solver == kExactName && e.finished()) return &e;
    }
    return nullptr;
}

std::string comparison_line(const std::vector<Entry>& entries, const Problem& problem,
                            std::string_view solver) {
    const Entry* best = cheapest(entries, problem, solver, kEqualError_m);
    if (best == nullptr) return fmt::format("  {:<20} does not reach it\n", solver);
    const Entry* exact = exact_on(entries, problem);
    const double ratio = exact ? best->cost.least_ns_per_ms / exact->cost.least_ns_per_ms : kNone;
    return fmt::format("  {:<20} {:<16} {:>8.1e} m {:>10.1f} ns/ms {:>8.2f} evaluations/ms {:>8.1f} x\n",
                       solver, best->contestant.setting(), best->accuracy.position_m,
                       best->cost.least_ns_per_ms, best->evaluations_per_ms, ratio);
}

}  // namespace

std::vector<const Problem*> problems_of(const std::vector<Entry>& entries) {
    std::vector<const Problem*> list;
    for (const Entry& e : entries) {
        if (list.empty() || list.back() != e.problem) list.push_back(e.problem);
    }
    return list;
}

void write_entries(const std::filesystem::path& file, const std::vector<Entry>& entries) {
    CsvFile out(file, IfExists::kReplace);
    out.write(
        "problem,kind,solver,step_s,tolerance,outcome,position_error_m,velocity_error_m_per_s,"
        "force_error_N,event_time_error_s,events,events_reference,evaluations_per_ms,"
        "cost_least_ns_per_ms,cost_median_ns_per_ms,runs\n");
    for (const Entry& e : entries) out.write(line_of(e));
    out.flush();
}

void write_real_time(const std::filesystem::path& file, const std::vector<RealTimeRow>& rows) {
    CsvFile out(file, IfExists::kReplace);
    out.write("problem,solver,step_s,outcome,p50_ns,p999_ns,worst_ns,holds\n");
    for (const RealTimeRow& r : rows) {
        out.write(fmt::format("{},{},{},{},{},{},{},{}\n", r.problem, r.solver, r.step_s, r.outcome, r.p50_ns,
                              r.p999_ns, r.worst_ns, r.holds() ? 1 : 0));
    }
    out.flush();
}

std::string comparison_table(const std::vector<Entry>& entries) {
    std::string table = fmt::format(
        "Cheapest setting with a position error of at most {:g} m and the right events; least time "
        "of all runs, ratio to exact\n",
        kEqualError_m);
    for (const Problem* problem : problems_of(entries)) {
        table += fmt::format("{} ({}): {}\n", problem->name, to_string(problem->kind), problem->about);
        for (const std::string_view solver : contestant_names()) {
            table += comparison_line(entries, *problem, solver);
        }
    }
    return table;
}

std::string exact_table(const std::vector<Entry>& entries) {
    std::string table =
        fmt::format("{:<16} {:<14} {:<14} {:>10} {:>10} {:>10} {:>10} {:>7} {:>9}\n", "exact on", "kind",
                    "outcome", "position_m", "velocity", "force_N", "event_s", "events", "ns/step");
    for (const Problem* problem : problems_of(entries)) {
        const Entry* e = exact_on(entries, *problem);
        if (e == nullptr) continue;
        table += fmt::format("{:<16} {:<14} {:<14} {:>10} {:>10} {:>10} {:>10} {:>7} {:>9.1f}\n",
                             problem->name, to_string(problem->kind), to_string(e->outcome),
                             number_text(e->accuracy.position_m), number_text(e->accuracy.velocity_m_per_s),
                             number_text(e->accuracy.force_N), number_text(e->accuracy.event_time_s),
                             e->accuracy.events, e->cost.least_ns_per_ms * problem->step_s * 1e3);
    }
    return table;
}

std::string real_time_table(const std::vector<RealTimeRow>& rows) {
    std::string table = fmt::format("{:<16} {:<20} {:>8} {:>10} {:>10} {:>10}  {}\n", "time of a step",
                                    "solver", "step_ms", "p50_ns", "p99.9_ns", "worst_ns", "holds");
    for (const RealTimeRow& r : rows) {
        table += fmt::format("{:<16} {:<20} {:>8g} ", r.problem, r.solver, r.step_s * 1e3);
        if (r.outcome != "ok") {
            table += fmt::format("{}\n", r.outcome);
            continue;
        }
        table += fmt::format("{:>10.0f} {:>10.0f} {:>10.0f}  {} kHz: {}\n", r.p50_ns, r.p999_ns, r.worst_ns,
                             std::round(1e-3 / r.step_s), r.holds() ? "yes" : "no");
    }
    return table;
}

}  // namespace thimble
