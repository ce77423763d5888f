// thimble report: one page from a run, a study, or both.
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "analysis/report/report.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/shared.hpp"

namespace thimble {
Subcommand add_report(CLI::App& app, const std::string& typed) {
    struct Arguments {
        std::string run_folder, study_folder, out;
    };
    const auto a = std::make_shared<Arguments>();
    CLI::App* report = app.add_subcommand("report", "write one report.html about a run, a study, or both");
    report->add_option("--run", a->run_folder, "folder that thimble run has written")->type_name("FOLDER");
    report->add_option("--study", a->study_folder, "folder that thimble study has written")
        ->type_name("FOLDER");
    report
        ->add_option(
            "-o,--out", a->out,
            "report to write; an earlier one is replaced. A file that ends in .html, or a folder for "
            "report.html")
        ->default_val("out/report.html")
        ->type_name("FILE|FOLDER");
    report->footer("Example:\n  thimble report --run out/run --study out/study --out out/report.html");
    return {
        report, [a, typed] {
            const auto file = output_file(a->out, "report.html");
            for (const Answer& answer : write_combined_report(a->run_folder, a->study_folder, file, typed)) {
                fmt::print("{}\n", answer.of);
                for (const std::string& sentence : answer.sentences) fmt::print("  {}\n", sentence);
            }
            fmt::print("results: {}\n", file.string());
            return 0;
        }};
}

}  // namespace thimble
