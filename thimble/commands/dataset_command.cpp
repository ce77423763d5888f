// thimble dataset: what is done with the data of participants after their sessions.
#include <cstdint>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "session/participant/motion_export.hpp"
#include "session/participant/run_participant.hpp"
#include "thimble/commands/commands.hpp"

namespace thimble {
namespace {

struct DatasetArguments {
    std::string folder, out, participant, reason;
    std::uint32_t trial = 0;
    int (*run)(const DatasetArguments&) = nullptr;
};

int exclude(const DatasetArguments& a) {
    exclude_trial(a.folder, a.participant, a.trial, a.reason);
    fmt::print("trial {} of {} is excluded: {}\n", a.trial, a.participant, a.reason);
    return 0;
}

int export_bids(const DatasetArguments& a) {
    const MotionExport done = export_motion(a.folder, a.out);
    fmt::print("{}: {} subjects, {} trials", a.out, done.subjects, done.trials);
    if (done.without_trajectory > 0) fmt::print("; {} trials have no trajectory", done.without_trajectory);
    fmt::print("\n");
    return 0;
}

CLI::App* add_dataset_part(CLI::App& dataset, const char* name, const char* what, DatasetArguments& a,
                           int (*run)(const DatasetArguments&)) {
    CLI::App* part = dataset.add_subcommand(name, what);
    part->callback([&a, run] { a.run = run; });
    return part;
}

}  // namespace

Subcommand add_dataset(CLI::App& app) {
    const auto arguments = std::make_shared<DatasetArguments>();
    DatasetArguments& a = *arguments;
    CLI::App* dataset =
        app.add_subcommand("dataset", "participants' data: leave a trial out, or export movements as BIDS");
    dataset->require_subcommand(1);
    CLI::App* leave_out = add_dataset_part(
        *dataset, "exclude", "leave a participant's trial out of the analysis, and say why", a, exclude);
    leave_out->add_option("folder", a.folder, "dataset of `thimble run` with a [protocol]")->required();
    leave_out->add_option("--participant", a.participant, "e.g. P07")->required();
    leave_out->add_option("--trial", a.trial, "its place in the participant's order (column 'position')")
        ->check(CLI::Range(1, 1000000))
        ->required();
    leave_out->add_option("--reason", a.reason, "goes into exclusions.tsv; no names")->required();
    CLI::App* bids = add_dataset_part(*dataset, "bids",
                                      "a Motion-BIDS dataset of the trajectories of participant sessions, "
                                      "a study or a run (docs/interoperability.md)",
                                      a, export_bids);
    bids->add_option("folder", a.folder,
                     "of a participant session, of thimble study --trajectories, or of thimble run")
        ->required();
    bids->add_option("-o,--out", a.out, "new folder")->required();
    dataset->footer(
        "Examples:\n  thimble dataset exclude out/study7 --participant P07 --trial 12 --reason \"phone "
        "rang\"\n"
        "  thimble dataset bids out/people --out out/bids\n\n"
        "Exit codes: 0 ok, 1 something could not be written, 2 usage, 5 there is nothing to be read.");
    return {dataset, [arguments] { return arguments->run(*arguments); }};
}

}  // namespace thimble
