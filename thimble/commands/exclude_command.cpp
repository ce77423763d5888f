// thimble exclude: leaves a participant's trial out of the analysis, with a reason.
#include <cstdint>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "session/participant/run_participant.hpp"
#include "thimble/commands/commands.hpp"

namespace thimble {
Subcommand add_exclude(CLI::App& app) {
    struct Arguments {
        std::string dataset, participant, reason;
        std::uint32_t trial = 0;
    };
    const auto a = std::make_shared<Arguments>();
    CLI::App* sub =
        app.add_subcommand("exclude", "leave a participant's trial out of the analysis, and say why");
    sub->add_option("dataset", a->dataset, "folder of `thimble run` with a [protocol]")->required();
    sub->add_option("--participant", a->participant, "e.g. P07")->required();
    sub->add_option("--trial", a->trial, "its place in the participant's order (column 'position')")
        ->check(CLI::Range(1, 1000000))
        ->required();
    sub->add_option("--reason", a->reason, "goes into exclusions.tsv; no names")->required();
    sub->footer(
        "Example:\n  thimble exclude out/study7 --participant P07 --trial 12 --reason \"phone rang\"");
    return {sub, [a] {
                exclude_trial(a->dataset, a->participant, a->trial, a->reason);
                fmt::print("trial {} of {} is excluded: {}\n", a->trial, a->participant, a->reason);
                return 0;
            }};
}

}  // namespace thimble
