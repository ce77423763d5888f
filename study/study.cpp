#include "study/study.hpp"

#include <algorithm>
#include <iterator>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "analysis/findings.hpp"
#include "analysis/report/report.hpp"
#include "analysis/report/report_tables.hpp"
#include "common/csv/csv_file.hpp"
#include "common/error.hpp"
#include "common/process/progress.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/text_file.hpp"
#include "common/version.hpp"
#include "session/records/trajectory_file.hpp"
#include "session/settings/system_settings.hpp"
#include "session/virtual/virtual_session.hpp"
#include "study/planned_table.hpp"
#include "study/study_folder.hpp"
#include "study/with_compensator.hpp"

namespace thimble {

namespace {

class Study {
  public:
    Study(const SystemSettings& settings, const StudyOptions& options)
        : settings_(settings), options_(options), jobs_(thread_count(options.jobs)) {}

    StudyResult run() {
        make_folder(options_.out);
        if (options_.if_exists == IfExists::kReplace) remove_earlier();
        run_table(all_trials(options_.protocols), "trials");
        if (wants_control() && result_.complete) {
            Protocol control = options_.protocols[0];
            control.delay_s = 0;
            run_table(all_trials({control}), "control");
        }
        if (options_.control && result_.complete) run_without_lag();
        if (result_.complete) run_with_compensators();
        // Not before a table: it is the one that refuses a folder with another study in it.
        write_subjects(options_.out / "subjects.csv", settings_.person, options_.protocols);
        findings_ = findings_of(result_.rows);
        write_findings(findings_, options_.out / "findings.json");
        write_claims();
        if (!result_.rows.empty()) report();
        return std::move(result_);
    }

  private:
    bool wants_control() const {
        return options_.control && options_.protocols.size() == 1 && options_.protocols[0].delay_s > 0;
    }

    void run_table(const std::vector<TrialConditions>& planned, const std::string& name) {
        run_table(settings_, planned, name, result_.rows, [&](const TrialCurve& curve) { add_curve(curve); });
    }

    // A study that is then interrupted must not go on with those of another.
    void remove_earlier() const {
        const auto table = options_.out / "trials.csv";
        std::error_code absent;
        if (std::filesystem::exists(table, absent))
            CsvFile(table, IfExists::kContinue);  // an Error if another program writes it
        remove_earlier_results(options_.out);
    }

    // A study goes on with its own session alone: the tables say little about it.
    void keep_plan(bool begins) const {
        const auto file = options_.out / "trials.txt";
        const std::string plan = options_.plan + session_text(settings_);
        if (!begins) return require_plan(file, "study", plan);
        write_text_file(file, plan);
    }

    void write_claims() {
        if (!options_.paper_design) return;
        result_.claims = judge_claims(result_.rows, no_lag_);
        thimble::write_claims(result_.claims, options_.out / "claims.json");
    }

    // Its rows are no part of the study's: they only tell what the lag costs.
    void run_without_lag() {
        const std::vector<TrialConditions> planned = no_lag_trials(options_.protocols);
        if (planned.empty()) return;
        run_table(without_lag(settings_), planned, "no_lag", no_lag_, [](const TrialCurve&) {});
    }

    void run_with_compensators() {
        for (const Compensator compensator : options_.compensators) {
            if (!result_.complete) return;
            run_table(with_control(settings_, control_for(settings_, compensator)),
                      force_feedback_trials(options_.protocols),
                      fmt::format("hf_{}", kCompensatorNames[static_cast<std::size_t>(compensator)]),
                      with_compensators_, [](const TrialCurve&) {});
        }
    }

    void run_table(const SystemSettings& settings, std::vector<TrialConditions> planned,
                   const std::string& name, std::vector<TrialRow>& rows, const TakeCurve& take_curve) {
        name_compensators(planned, settings);
        StudyTables tables(options_.out, name, options_.if_exists, planned, take_curve, options_.curves);
        if (name == "trials") keep_plan(tables.rows().empty());
        check_trajectories(tables.rows(), name);
        rows.insert(rows.end(), tables.rows().begin(), tables.rows().end());
        std::size_t done = tables.rows().size();
        result_.resumed += done;
        const auto left = std::span(planned).subspan(done);
        const SessionTime start = wall_now();
        result_.complete = run_trials(settings, left, jobs_, options_.stop, [&](const TrialRecord& record) {
            if (options_.trajectories) save_trajectory(record, name);
            rows.push_back(make_row(record));
            const TrialCurve curve = trial_curve(record, options_.curves);
            tables.append(rows.back(), curve);
            take_curve(curve);
            if (!record.samples.empty()) result_.simulated_s += record.samples.back().time_s;
            show(record.conditions, ++done, planned.size(), start);
        });
        result_.wall_s += to_seconds(wall_now() - start);
        progress_.close();
    }

    void show(const TrialConditions& c, std::size_t done, std::size_t all, SessionTime start) {
        const double wall_s = result_.wall_s + to_seconds(wall_now() - start);
        progress_.count(done, all, "trials",
                        fmt::format("experiment {}, {}, subject {}, {:.0f} x real time on {} threads",
                                    c.experiment, delay_text(c.delay_s), c.subject,
                                    result_.simulated_s / std::max(wall_s, 1e-9), jobs_));
    }

    void add_curve(const TrialCurve& curve) {
        panels_.try_emplace(curve.conditions.experiment, options_.curves).first->second.add(curve);
    }

    // The other tables have the same trials again, so the files of these have the table's name.
    std::filesystem::path trajectory_file(const TrialConditions& c, const std::string& table) const {
        const bool own_trials = table == "trials" || table == "control";
        return options_.out / "trajectories" /
               fmt::format("experiment{}_subject{:02}_trial{:02}_{}_{}{}.csv", c.experiment, c.subject,
                           c.trial, to_string(c.modality), delay_in_names(c.delay_s),
                           own_trials ? "" : "_" + table);
    }

    // A study that goes on keeps the trajectories of all its trials, or of none.
    void check_trajectories(const std::vector<TrialRow>& done, const std::string& table) const {
        if (done.empty()) return;
        const auto missing = std::find_if(done.begin(), done.end(), [&](const TrialRow& row) {
            std::error_code unknown;
            return !std::filesystem::exists(trajectory_file(row.conditions, table), unknown);
        });
        if (missing == done.end() && !options_.trajectories)
            throw Error(ExitCode::kUsage,
                        "{}: this study keeps trajectories: add --trajectories to --resume, or start again "
                        "with --overwrite",
                        options_.out.string());
        if (missing != done.end() && options_.trajectories)
            throw Error(ExitCode::kUsage,
                        "{}: is missing, though its trial is done: leave out --trajectories, or start again "
                        "with --overwrite",
                        trajectory_file(missing->conditions, table).string());
    }

    void save_trajectory(const TrialRecord& record, const std::string& table) const {
        make_folder(options_.out / "trajectories");
        const bool again = options_.if_exists != IfExists::kRefuse;
        TrajectoryWriter writer(trajectory_file(record.conditions, table),
                                again ? IfExists::kReplace : IfExists::kRefuse);
        writer.append(record.samples);
        writer.end(record.reason, record.lost_peer);
    }

    ReportSection claims_section() const {
        ReportSection section;
        section.title = "The paper's claims";
        section.text =
            claims_sentence(result_.claims) +
            ". To count how often each claim is reproduced over many seeds, use thimble study --seeds.";
        section.tables = {claims_table(result_.claims)};
        return section;
    }

    ReportSection section(std::uint32_t experiment, const StudyFigures& figures) const {
        std::vector<GroupFindings> own = findings_;
        std::erase_if(own, [&](const GroupFindings& group) { return group.experiment != experiment; });
        const std::vector<TrialRow> rows = of_experiment(result_.rows, experiment);
        ReportSection section =
            trials_section(title_of(experiment), rows, own, figures.experiments.at(experiment));
        for (ReportTable& table : order_tables(rows)) section.tables.push_back(std::move(table));
        return section;
    }

    std::string title_of(std::uint32_t experiment) const {
        return panels_.size() == 1 ? "Virtual study" : fmt::format("Experiment {}", experiment);
    }

    // HF, each compensator, CF, CCF and VF.
    ReportSection compensators_section() const {
        std::vector<TrialRow> rows = result_.rows;
        rows.insert(rows.end(), with_compensators_.begin(), with_compensators_.end());
        const std::vector<GroupFindings> findings = findings_of(rows);
        write_findings(findings, options_.out / "compensators.json");
        ReportSection section;
        section.title = "Delay compensators";
        section.text =
            "The HF trials again, with a delay compensator in the loop of the handle. Subjects, fixtures and "
            "delays are the same.";
        section.findings = answer(findings);
        section.tables = finding_tables(findings);
        return section;
    }

    std::string experiments() const {
        std::string names;
        for (const Protocol& protocol : options_.protocols) {
            names += fmt::format("{}{}", names.empty() ? "" : ", ", protocol.experiment);
        }
        return names;
    }

    std::string design() const {
        if (!options_.paper_design) return kUsersDesign;
        if (!settings_.file.empty() && !is_paper_session(settings_.file))
            return "the paper's trials with another session";
        std::string sessions;
        for (const Protocol& protocol : options_.protocols)
            sessions +=
                fmt::format("{}{}", sessions.empty() ? "" : ", ", kPaperSessions.at(protocol.experiment - 1));
        return sessions;
    }

    std::string title() const {
        if (!options_.paper_design) return "Thimble: a study in virtual time";
        return fmt::format("Thimble: experiment{} {} in virtual time",
                           options_.protocols.size() > 1 ? "s" : "", experiments());
    }

    void report() const {
        ReportInput report;
        report.title = title();
        report.answers = {{"", answer(findings_)}};
        const StudyFigures figures = draw_study(result_.rows, panels_, options_.out);
        if (panels_.size() > 1)
            report.sections.push_back({"The experiments side by side", "", {}, {}, figures.side_by_side, {}});
        for (const auto& [experiment, panels] : panels_)
            report.sections.push_back(section(experiment, figures));
        if (!with_compensators_.empty()) report.sections.push_back(compensators_section());
        if (!options_.person.empty())
            report.sections.push_back({"This person's hand", "", {}, {}, {}, options_.person});
        if (options_.paper_design) report.sections.push_back(claims_section());
        const Protocol& protocol = options_.protocols[0];
        report.provenance = {{"command", options_.command},
                             {kDesign, design_},
                             {"seed", std::to_string(protocol.seed)},
                             {"subjects", std::to_string(protocol.subjects)},
                             {"order of trials", to_string(protocol.order)},
                             {"version", kVersion},
                             {"complete", result_.complete ? "yes" : "no, interrupted"}};
        report.provenance.insert(report.provenance.end(), options_.made_with.begin(),
                                 options_.made_with.end());
        say_virtual_subjects(report);
        write_report(report, options_.out / "report.html");
        write_summary(report, options_.out / "summary.json");
    }

    const SystemSettings& settings_;
    const StudyOptions& options_;
    const std::string design_ = design();  // of the session file as it is now
    unsigned jobs_;
    Progress progress_;
    PanelsByExperiment panels_;
    std::vector<GroupFindings> findings_;
    std::vector<TrialRow> no_lag_, with_compensators_;
    StudyResult result_;
};

}  // namespace

StudyResult run_study(const SystemSettings& settings, const StudyOptions& options) {
    return Study(settings, options).run();
}

std::vector<TrialConditions> no_lag_trials(const std::vector<Protocol>& protocols) {
    std::vector<TrialConditions> again;
    for (const Protocol& protocol : protocols) {
        if (protocol.experiment != 1) continue;
        const std::vector<TrialConditions> all = all_trials({protocol});
        std::copy_if(all.begin(), all.end(), std::back_inserter(again),
                     [](const TrialConditions& trial) { return trial.modality == Modality::kCF; });
    }
    return again;
}

SystemSettings without_lag(SystemSettings settings) {
    settings.cutaneous.dead_time = Duration{0};
    settings.cutaneous.time_constant = Duration{0};
    return settings;
}

bool run_trials(const SystemSettings& settings, std::span<const TrialConditions> trials, unsigned jobs,
                const std::atomic<bool>* stop, const std::function<void(const TrialRecord&)>& take) {
    OrderedWorkers<TrialRecord> workers(
        trials.size(), thread_count(jobs),
        [&](std::size_t i) { return run_virtual_trial(settings, trials[i]); }, stop);
    for (std::size_t i = 0; i < trials.size(); ++i) {
        const std::optional<TrialRecord> record = workers.take();
        if (!record) return false;
        take(*record);
    }
    return true;
}

}  // namespace thimble
