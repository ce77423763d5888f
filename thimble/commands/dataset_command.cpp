// thimble dataset: what is done with the data of participants after their sessions.
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/runtime/wall_clock.hpp"
#include "session/participant/corrections.hpp"
#include "session/participant/dataset.hpp"
#include "session/participant/phenotype.hpp"
#include "thimble/commands/commands.hpp"

namespace thimble {
namespace {

constexpr const char* kDatasetExitCodes =
    "Exit codes: 0 ok, 1 a file could not be written, 2 usage, 5 the data are missing or damaged.";
constexpr const char* kExcludeExample =
    "thimble dataset exclude out/study7 --participant P07 --trial 12 --reason \"phone rang\"";
constexpr const char* kIncludeExample =
    "thimble dataset include out/study7 --participant P07 --trial 12 --reason \"wrong trial\"";
constexpr const char* kCorrectExample =
    "thimble dataset correct out/study7 --participant P07 --column age --value 32 --reason \"typing "
    "error\" --by LS";
constexpr const char* kBidsExample = "thimble dataset bids out/people --out out/bids";

struct DatasetArguments {
    std::string folder, out, participant, reason, by, column, value;
    std::uint32_t trial = 0;
    int (*run)(const DatasetArguments&) = nullptr;
};

// By the user of this computer, unless --by says otherwise.
CorrectionNote note_of(const DatasetArguments& a) {
    const char* const user = std::getenv("USER");  // NOLINT(concurrency-mt-unsafe): no thread yet
    return {a.by.empty() && user != nullptr ? user : a.by, a.reason, utc_text(read_clock_pair().realtime_ns)};
}

int include(const DatasetArguments& a) {
    include_trial(a.folder, a.participant, a.trial, note_of(a));
    fmt::print("trial {} of {} is included again: {}\n", a.trial, a.participant, a.reason);
    return 0;
}

int correct(const DatasetArguments& a) {
    const std::string written = correct_person(a.folder, a.participant, a.column, a.value, note_of(a));
    fmt::print("{} of {} is now {}: {}\n", a.column, a.participant, written, a.reason);
    return 0;
}

int exclude(const DatasetArguments& a) {
    exclude_trial(a.folder, a.participant, a.trial, note_of(a));
    fmt::print("trial {} of {} is excluded: {}\n", a.trial, a.participant, a.reason);
    return 0;
}

int export_bids(const DatasetArguments& a) {
    const MotionExport done = export_motion(a.folder, a.out);
    fmt::print("{} subjects, {} trials", done.subjects, done.trials);
    if (done.without_trajectory > 0) fmt::print("; {} trials have no trajectory", done.without_trajectory);
    fmt::print("\nresults: {}\n", a.out);
    return 0;
}

CLI::App* add_dataset_part(CLI::App& dataset, const char* name, const char* what, const char* example,
                           DatasetArguments& a, int (*run)(const DatasetArguments&)) {
    CLI::App* part = dataset.add_subcommand(name, what);
    part->footer(fmt::format("Example:\n  {}\n\n{}", example, kDatasetExitCodes));
    part->callback([&a, run] { a.run = run; });
    return part;
}

void add_correction_options(CLI::App& part, DatasetArguments& a) {
    part.add_option("folder", a.folder, "dataset folder of thimble run with [protocol]")->required();
    part.add_option("--participant", a.participant, "participant, e.g. P07")->required();
    part.add_option("--reason", a.reason, "reason, written to corrections.tsv; do not name people")
        ->required();
    part.add_option("--by", a.by,
                    "who decided, written to corrections.tsv; default: the user of this computer");
}

}  // namespace

Subcommand add_dataset(CLI::App& app) {
    const auto arguments = std::make_shared<DatasetArguments>();
    DatasetArguments& a = *arguments;
    CLI::App* dataset = app.add_subcommand(
        "dataset", "exclude or include participants' trials, correct a field, or export movements as BIDS");
    dataset->require_subcommand(1);
    CLI::App* leave_out = add_dataset_part(
        *dataset, "exclude", "exclude a participant's trial from the analysis", kExcludeExample, a, exclude);
    CLI::App* take_back = add_dataset_part(
        *dataset, "include", "include a trial that was excluded or rejected", kIncludeExample, a, include);
    CLI::App* person =
        add_dataset_part(*dataset, "correct", "correct a participant's age, sex, handedness or experience",
                         kCorrectExample, a, correct);
    for (CLI::App* part : {leave_out, take_back, person}) add_correction_options(*part, a);
    for (CLI::App* part : {leave_out, take_back})
        part->add_option("--trial", a.trial,
                         "number of the trial in the participant's order (column 'position')")
            ->check(CLI::Range(1, 1000000))
            ->required();
    person->add_option("--column", a.column, "column of participants.tsv")
        ->check(CLI::IsMember({"age", "sex", "handedness", "haptic_experience"}))
        ->required();
    person->add_option("--value", a.value, "correct value")->required();
    CLI::App* bids = add_dataset_part(*dataset, "bids",
                                      "export the trajectories of participants, a study or a run as a "
                                      "Motion-BIDS dataset (docs/interoperability.md)",
                                      kBidsExample, a, export_bids);
    bids->add_option("folder", a.folder,
                     "folder of a participant session, of thimble study --trajectories, or of thimble run")
        ->required();
    bids->add_option("-o,--out", a.out, "new folder")->required();
    dataset->footer(fmt::format("Examples:\n  {}\n  {}\n  {}\n  {}\n\n{}", kExcludeExample, kIncludeExample,
                                kCorrectExample, kBidsExample, kDatasetExitCodes));
    return {dataset, [arguments] { return arguments->run(*arguments); }};
}

}  // namespace thimble
