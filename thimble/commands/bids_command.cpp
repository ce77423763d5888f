// thimble bids: recorded movements for others, in the layout of Motion-BIDS.
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "session/participant/motion_export.hpp"
#include "thimble/commands/commands.hpp"

namespace thimble {
Subcommand add_bids(CLI::App& app) {
    struct Arguments {
        std::string from, out;
    };
    const auto a = std::make_shared<Arguments>();
    CLI::App* bids = app.add_subcommand("bids",
                                        "a Motion-BIDS dataset of the trajectories of participant sessions, "
                                        "a study or a run (docs/interoperability.md)");
    bids->add_option("folder", a->from,
                     "of a participant session, of thimble study --trajectories, or of thimble run")
        ->required();
    bids->add_option("-o,--out", a->out, "new folder")->required();
    bids->footer(
        "Example:\n  thimble bids out/people --out out/bids\n\nExit codes: 0 ok, 1 something could not be "
        "written, "
        "2 usage, 5 there is nothing to be read.");
    return {bids, [a] {
                const MotionExport done = export_motion(a->from, a->out);
                fmt::print("{}: {} subjects, {} trials", a->out, done.subjects, done.trials);
                if (done.without_trajectory > 0)
                    fmt::print("; {} trials have no trajectory", done.without_trajectory);
                fmt::print("\n");
                return 0;
            }};
}

}  // namespace thimble
