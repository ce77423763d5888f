#include "experiment/study.hpp"

#include <algorithm>
#include <thread>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/version.hpp"
#include "experiment/progress.hpp"
#include "experiment/report.hpp"
#include "experiment/trajectory_file.hpp"

namespace thimble {
namespace {

class Study {
  public:
    Study(const SystemSettings& settings, const StudyOptions& options)
        : settings_(settings),
          options_(options),
          jobs_(options.jobs != 0 ? options.jobs : std::max(1U, std::thread::hardware_concurrency())) {}

    StudyResult run() {
        std::filesystem::create_directories(options_.out);
        run_condition(options_.protocol, "trials.csv");
        if (options_.control && options_.protocol.delay_s > 0 && result_.complete) {
            Protocol control = options_.protocol;
            control.delay_s = 0;
            run_condition(control, "control.csv");
        }
        if (!result_.rows.empty()) report();
        return std::move(result_);
    }

  private:
    void run_condition(const Protocol& protocol, const std::string& file_name) {
        const std::vector<TrialConditions> trials = all_trials(protocol);
        TrialTable table(options_.out / file_name,
                         options_.overwrite ? IfExists::kReplace : IfExists::kRefuse);
        std::size_t done = 0;
        const SessionTime start = wall_now();
        result_.complete =
            run_trials(settings_, trials, jobs_, options_.stop, [&](const TrialRecord& record) {
                keep(record, table);
                ++done;
                const std::string line =
                    fmt::format("{} ms: {}/{} trials, subject {}, {}", 1000 * protocol.delay_s, done,
                                trials.size(), record.conditions.subject, speed_text(start));
                progress_.show(line, done == trials.size() || done % (trials.size() / 4 + 1) == 0);
            });
        result_.wall_s += to_seconds(wall_now() - start);
        progress_.say(fmt::format("{} ms: {} of {} trials in {}", 1000 * protocol.delay_s, done,
                                  trials.size(), (options_.out / file_name).string()));
    }

    void keep(const TrialRecord& record, TrialTable& table) {
        if (options_.trajectories) save_trajectory(record);
        result_.rows.push_back(make_row(record));
        table.append(result_.rows.back());
        panels_.add(record);
        if (!record.samples.empty()) result_.simulated_s += record.samples.back().time_s;
    }

    void save_trajectory(const TrialRecord& record) const {
        const TrialConditions& c = record.conditions;
        const auto folder = options_.out / "trajectories";
        std::filesystem::create_directories(folder);
        TrajectoryWriter writer(folder / fmt::format("subject{:02}_trial{:02}_{}_{:g}ms.csv", c.subject,
                                                     c.trial, to_string(c.modality), 1000 * c.delay_s),
                                options_.overwrite ? IfExists::kReplace : IfExists::kRefuse);
        writer.append(record.samples);
        writer.end(record.reason, record.lost_peer);
    }

    std::string speed_text(SessionTime start) const {
        const double wall_s = result_.wall_s + to_seconds(wall_now() - start);
        return fmt::format("{:.0f} x real time on {} threads", result_.simulated_s / std::max(wall_s, 1e-9),
                           jobs_);
    }

    void report() const {
        const auto conditions = summarize(result_.rows);
        ReportInput report;
        report.title = fmt::format("Thimble: experiment {} in virtual time", options_.protocol.experiment);
        report.sections.push_back(trials_section("Virtual study", result_.rows,
                                                 draw_figures(panels_.panels(), conditions, options_.out)));
        report.provenance = {{"command", options_.command},
                             {"seed", std::to_string(options_.protocol.seed)},
                             {"subjects", std::to_string(options_.protocol.subjects)},
                             {"version", kVersion},
                             {"complete", result_.complete ? "yes" : "no, interrupted"}};
        write_report(report, options_.out / "report.html");
        write_summary(report, options_.out / "summary.json");
    }

    const SystemSettings& settings_;
    const StudyOptions& options_;
    unsigned jobs_;
    Progress progress_;
    TrajectoryPanels panels_;
    StudyResult result_;
};

}  // namespace

StudyResult run_study(const SystemSettings& settings, const StudyOptions& options) {
    return Study(settings, options).run();
}

}  // namespace thimble
