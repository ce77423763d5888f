
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/csv/csv.hpp"
#include "common/csv/csv_file.hpp"
#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/text_file.hpp"
#include "common/version.hpp"
#include "session/participant/dataset.hpp"
#include "session/participant/record_table.hpp"
#include "session/participant/tsv.hpp"
#include "session/records/trajectory_file.hpp"
#include "session/records/trial_table.hpp"

namespace thimble {
namespace {

using MotionJson = nlohmann::ordered_json;
namespace fs = std::filesystem;

// A trial, and what it is called there.
struct MotionTrial {
    std::string task;
    std::uint32_t run = 1;
    TrialRow row;
    fs::path trajectory;
};

struct MotionColumn {
    const char *name, *component, *type, *point, *units, *description;
    double TrajectorySample::*member;
};

// BIDS has no type for forces.
constexpr std::array kMotionColumns{
    MotionColumn{"time", "n/a", "LATENCY", "n/a", "s", "Since the start of the trial",
                 &TrajectorySample::time_s},
    MotionColumn{"needle_pos", "z", "POS", "needle", "m", "Tip of the needle, positive into the tissue",
                 &TrajectorySample::position_needle_m},
    MotionColumn{"surface_pos", "z", "POS", "tissue_surface", "m", "Surface of the tissue at the needle",
                 &TrajectorySample::position_surface_m},
    MotionColumn{"force_tissue", "z", "MISC", "needle", "N",
                 "Of the tissue on the operator; negative resists insertion",
                 &TrajectorySample::force_tissue_N},
    MotionColumn{"force_fixture", "z", "MISC", "needle", "N", "Of the virtual fixture on the operator",
                 &TrajectorySample::force_fixture_N},
    MotionColumn{"force_total", "z", "MISC", "needle", "N", "Sum of both forces",
                 &TrajectorySample::force_total_N}};

std::string samples_text(const std::vector<TrajectorySample>& samples) {
    std::string text;
    for (const TrajectorySample& sample : samples) {
        for (std::size_t i = 0; i < kMotionColumns.size(); ++i) {
            text += fmt::format("{}{}", sample.*kMotionColumns[i].member,
                                i + 1 < kMotionColumns.size() ? '\t' : '\n');
        }
    }
    return text;
}

std::string channels_text() {
    std::string text = "name\tcomponent\ttype\ttracked_point\tunits\tdescription\n";
    for (const MotionColumn& c : kMotionColumns) {
        text += fmt::format("{}\t{}\t{}\t{}\t{}\t{}\n", c.name, c.component, c.type, c.point, c.units,
                            c.description);
    }
    return text;
}

// Of the samples as they were planned: the middle one of their intervals, to the microsecond. Lost ones leave gaps.
long sampling_frequency_Hz(const std::vector<TrajectorySample>& samples) {
    std::vector<double> intervals_s;
    for (std::size_t i = 1; i < samples.size(); ++i)
        intervals_s.push_back(samples[i].time_s - samples[i - 1].time_s);
    const auto middle = intervals_s.begin() + static_cast<std::ptrdiff_t>(intervals_s.size() / 2);
    std::nth_element(intervals_s.begin(), middle, intervals_s.end());
    return std::lround(1e6 / std::max(1.0, std::round(1e6 * *middle)));
}

std::string motion_json(const MotionTrial& trial, const std::vector<TrajectorySample>& samples) {
    const double seconds = samples.back().time_s - samples.front().time_s;
    MotionJson json{{"TaskName", trial.task},
                    {"TaskDescription",
                     "Insert a needle into simulated tissue until a virtual fixture is felt or seen, hold "
                     "the contact until the beep, withdraw."},
                    {"SamplingFrequency", sampling_frequency_Hz(samples)},
                    {"TrackingSystemName", "slave"},
                    {"Manufacturer", "Thimble"},
                    {"SoftwareVersions", kVersion},
                    {"MotionChannelCount", kMotionColumns.size()},
                    {"TrackedPointsCount", 2},
                    {"POSChannelCount", 2},
                    {"LATENCYChannelCount", 1},
                    {"MISCChannelCount", 3},
                    {"MissingValues", "n/a"},
                    {"RecordingDuration", seconds}};
    if (seconds > 0) json["SamplingFrequencyEffective"] = static_cast<double>(samples.size() - 1) / seconds;
    return json_text(json, 2) + '\n';
}

// Instants, so without a duration; the first one says what the trial was. `zero_s`: of the first sample, from which onsets count.
std::string events_text(const TrialRow& row, double zero_s) {
    const TrialConditions& c = row.conditions;
    std::string text = "onset\tduration\ttrial_type\tmodality\tdelay_s\tfixture_position_m\toutcome\n";
    text += fmt::format("0\t0\ttrial_start\t{}\t{}\t{}\t{}\n", to_string(c.modality), c.delay_s,
                        c.fixture_position_m, outcome_text(row.reason, row.lost_peer));
    const auto add = [&](double time_s, const char* what) {
        if (!std::isnan(time_s))
            text += fmt::format("{}\t0\t{}\tn/a\tn/a\tn/a\tn/a\n", time_s - zero_s, what);
    };
    add(row.metrics.puncture_time_s, "puncture");
    add(row.metrics.first_contact_time_s, "fixture_contact");
    if (row.metrics.beeped) add(row.metrics.puncture_time_s + row.metrics.completion_time_s, "beep");
    return text;
}

std::string events_json() {
    const MotionJson json{
        {"trial_type",
         {{"Description", "What happened"},
          {"Levels",
           {{"trial_start", "The first sample"},
            {"puncture", "The needle has entered the tissue"},
            {"fixture_contact", "The needle has reached the virtual fixture"},
            {"beep", "Contact has been held long enough; the needle is to be withdrawn"}}}}},
        {"modality",
         {{"Description", "How the force was displayed"},
          {"Levels",
           {{"HF", "handle"},
            {"CF", "fingers of the acting hand"},
            {"CCF", "fingers of the other hand"},
            {"VF", "bar on the screen"}}}}},
        {"delay_s", {{"Description", "One-way delay of the force path that was asked for"}, {"Units", "s"}}},
        {"fixture_position_m", {{"Description", "Depth of the virtual fixture"}, {"Units", "m"}}},
        {"outcome", {{"Description", "How the trial ended; completed: after the beep"}}}};
    return json_text(json, 2) + '\n';
}

void write_motion_text(const fs::path& path, const std::string& text) {
    make_folder(path.parent_path());
    CsvFile file(path, IfExists::kRefuse);
    file.write(text);
    file.flush();
}

class MotionDataset {
  public:
    MotionDataset(const fs::path& from, const fs::path& to) : from_(from), to_(to) {}

    void add_trial(const MotionTrial& trial) {
        std::error_code absent;
        const Trajectory trajectory = fs::exists(trial.trajectory, absent)
                                          ? read_trajectory(trial.trajectory, LastLine::kMayBeTorn)
                                          : Trajectory{};
        if (trajectory.samples.size() < 2) {  // one alone is no movement
            ++done_.without_trajectory;
            return;
        }
        const std::string id = participant_id(trial.row.conditions.subject);
        const std::string stem =
            fmt::format("{}_task-{}_tracksys-slave_run-{:02}_", id, trial.task, trial.run);
        const fs::path folder = to_ / id / "motion";
        write_motion_text(folder / (stem + "motion.tsv"), samples_text(trajectory.samples));
        write_motion_text(folder / (stem + "motion.json"), motion_json(trial, trajectory.samples));
        write_motion_text(folder / (stem + "channels.tsv"), channels_text());
        write_motion_text(folder / (stem + "events.tsv"),
                          events_text(trial.row, trajectory.samples.front().time_s));
        write_motion_text(folder / (stem + "events.json"), events_json());
        subjects_.insert(trial.row.conditions.subject);
        ++done_.trials;
    }
    void copy(const fs::path& name) const {
        std::error_code absent;
        if (fs::exists(from_ / name, absent)) write_motion_text(to_ / name, read_whole_file(from_ / name));
    }
    const std::set<std::uint32_t>& subjects() const { return subjects_; }
    MotionExport finish(std::string_view advice) {
        if (done_.trials == 0)
            throw Error(ExitCode::kData, "{}: no trial has a trajectory; {}", from_.string(), advice);
        done_.subjects = subjects_.size();
        return done_;
    }

  private:
    fs::path from_, to_;
    std::set<std::uint32_t> subjects_;
    MotionExport done_;
};

MotionJson read_description(const fs::path& path) {
    std::ifstream file(path);
    MotionJson json = MotionJson::parse(file, nullptr, false);
    if (json.is_object()) return json;
    throw Error(ExitCode::kData, "{}: is not a JSON object; restore it", path.string());
}

// BIDS knows movements since 1.9.
void write_motion_description(const fs::path& to, MotionJson json) {
    json["BIDSVersion"] = "1.9.0";
    write_motion_text(to / "dataset_description.json", json_text(json, 2) + '\n');
}

void export_participant_session(const Dataset& dataset, const fs::path& to, MotionDataset& out) {
    for (const std::uint32_t participant : read_participants(dataset)) {
        const fs::path folder = dataset.source(participant) / "trajectories";
        for (const DatasetRecord& record : read_records(dataset.records(participant))) {
            const TrialConditions& c = record.row.conditions;
            const std::string name =
                fmt::format("record{:03}_experiment{}_{}", record.record, c.experiment, trajectory_name(c));
            out.add_trial({"needle", record.record, record.row, folder / name});
        }
        for (const fs::path& file : {dataset.records(participant), dataset.order(participant)})
            out.copy(fs::relative(file, dataset.folder()));
    }
    for (const char* name : {"participants.tsv", "participants.json", "task-needle_beh.json", "README.md",
                             "exclusions.tsv", "attention.tsv", "corrections.tsv", ".bidsignore"})
        out.copy(name);
    std::error_code absent;
    for (const auto& file : fs::directory_iterator(dataset.folder() / "phenotype", absent)) {
        const auto ending = file.path().extension();  // a crash may leave others
        if (ending == ".tsv" || ending == ".json") out.copy(fs::path("phenotype") / file.path().filename());
    }
    write_motion_description(to, read_description(dataset.description()));
}

// Of a run, its report says it. `thimble play` writes none.
bool report_says_virtual(const fs::path& from) {
    std::ifstream file(from / "summary.json");
    const MotionJson json = MotionJson::parse(file, nullptr, false);
    const MotionJson::json_pointer kind("/provenance/kind of subjects");
    return json.contains(kind) && json.at(kind) == to_string(SubjectKind::kVirtual);
}

// Only a study, which has virtual subjects alone, gives such names: also where it was killed, and has no report.
bool is_of_study(const fs::path& trajectory) {
    return trajectory.filename().string().starts_with("experiment");
}

void write_motion_subjects(const fs::path& to, const std::set<std::uint32_t>& subjects, const char* kind) {
    std::string participants = "participant_id\tspecies\tsubject_kind\n";
    for (const std::uint32_t subject : subjects)
        participants += fmt::format("{}\tn/a\t{}\n", participant_id(subject), kind);
    write_motion_text(to / "participants.tsv", participants);
    write_motion_text(
        to / "participants.json",
        json_text(MotionJson{{"species", {{"Description", "n/a: a virtual subject, or not recorded"}}},
                             {"subject_kind",
                              {{"Description", "Who held the handle; n/a: not recorded"},
                               {"Levels", {{"virtual", "a simulated operator"}}}}}},
                  2) +
            '\n');
}

void write_motion_origin(const fs::path& to, bool is_virtual) {
    const std::string name = is_virtual ? "Virtual subjects inserting a needle" : "Insertions of a needle";
    const char* const words = is_virtual
                                  ? "Trajectories of `thimble study` or `thimble run`: a simulated operator, "
                                    "simulated tissue, emulated network. No person took part.\n"
                                  : "Trajectories of `thimble run` or `thimble play`, whose folder does not "
                                    "say that a simulated operator held the handle.\n";
    write_motion_text(to / "README.md", fmt::format("# {}\n\n{}", name, words));
    MotionJson json{
        {"Name", name},
        {"DatasetType", "raw"},
        {"GeneratedBy", MotionJson::array({MotionJson{{"Name", "Thimble"}, {"Version", kVersion}}})}};
    if (is_virtual) json["SubjectKind"] = to_string(SubjectKind::kVirtual);
    write_motion_description(to, json);
}

void export_study(const fs::path& from, const fs::path& to, MotionDataset& out) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> runs;
    bool of_study = true;
    for (const TrialRow& row : read_trial_table(from / "trials.csv")) {
        const TrialConditions& c = row.conditions;
        const fs::path trajectory = find_trajectory(from / "trajectories", c);
        of_study = of_study && (trajectory.empty() || is_of_study(trajectory));
        out.add_trial({fmt::format("needleExperiment{}", c.experiment), ++runs[{c.experiment, c.subject}],
                       row, trajectory});
    }
    const bool is_virtual = of_study || report_says_virtual(from);
    write_motion_subjects(to, out.subjects(), is_virtual ? "virtual" : "n/a");
    write_motion_origin(to, is_virtual);
}

MotionExport exported(const fs::path& from, const fs::path& to) {
    const Dataset dataset(from);
    MotionDataset out(from, to);
    if (dataset.kind()) {
        export_participant_session(dataset, to, out);
    } else if (is_table(from / "trials.csv")) {
        export_study(from, to, out);
    } else {
        throw Error(ExitCode::kUsage,
                    "{}: holds neither the dataset of a participant session nor the trials.csv of a study",
                    from.string());
    }
    return out.finish(dataset.kind() ? "run a trial of a participant first, or restore sourcedata/"
                                     : "run thimble study with --trajectories, or restore trajectories/");
}

}  // namespace

MotionExport export_motion(const fs::path& from, const fs::path& to) {
    std::error_code absent;
    if (fs::exists(to, absent) && !fs::is_empty(to, absent)) {
        throw Error(ExitCode::kUsage, "{}: is not empty; name a new folder with --out", to.string());
    }
    try {
        return exported(from, to);
    } catch (...) {
        // It was empty: whatever is there is half of what was asked for, and in the way of the next try.
        for (const auto& entry : fs::directory_iterator(to, absent)) fs::remove_all(entry.path(), absent);
        throw;
    }
}

}  // namespace thimble
