// thimble-netem fit: a measured path becomes a profile.
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/error.hpp"
#include "common/own_program.hpp"
#include "common/text_file.hpp"
#include "netem/commands/commands.hpp"
#include "netem/formats/jitter_table_file.hpp"
#include "netem/formats/path_fit.hpp"
#include "netem/formats/text_lines.hpp"
#include "netem/formats/trace_files.hpp"
#include "netem/profiles/profiles.hpp"

namespace thimble {
namespace {

struct FitArguments {
    std::string up, down;  // traces (CSV); without `down` both directions are alike
    std::string out;       // profile (TOML); empty: only say what was found
    std::string table;     // .dist of the standardised delays upwards; empty: none
};

MeasuredPath load(const std::string& file) {
    MeasuredPath path = parse_path(read_whole_file(file), file);
    require_fates(path, file);
    return path;
}

PathFit fit_and_say(const MeasuredPath& path, const std::string& file) {
    PathFit fit = fit_path(path);
    fmt::print("{}\n", file);
    for (const std::string& remark : path.remarks) fmt::print("  {}\n", remark);
    for (const std::string& sentence : fit.sentences) fmt::print("  {}\n", sentence);
    return fit;
}

std::vector<std::string> source_of(const std::string& file, const MeasuredPath& path, const PathFit& fit) {
    std::vector<std::string> source{fmt::format("fitted to {} ({} packets)", file, fit.packets)};
    source.insert(source.end(), path.remarks.begin(), path.remarks.end());
    source.insert(source.end(), fit.sentences.begin(), fit.sentences.end());
    return source;
}

// By it an editor checks the file and completes its keys (docs/session-files.md).
std::string schema_line() {
    std::error_code absent;
    const auto schema = shipped_files() / "schema/profile.json";
    return std::filesystem::exists(schema, absent) ? fmt::format("#:schema {}\n", schema.string()) : "";
}

int fit(const FitArguments& a) {
    refuse_same_file({a.up, a.down}, {a.out, a.table});
    const MeasuredPath up = load(a.up);
    const PathFit up_fit = fit_and_say(up, a.up);
    LinkProfile profile;
    profile.about = "Fitted to a measured path";
    profile.up = profile.down = up_fit.link;
    profile.source = source_of(a.up, up, up_fit);
    if (a.down.empty()) {
        profile.source.emplace_back("one direction was measured; the profile uses it for both");
    } else {
        const MeasuredPath down = load(a.down);
        const PathFit down_fit = fit_and_say(down, a.down);
        profile.down = down_fit.link;
        for (std::string& line : source_of(a.down, down, down_fit)) profile.source.push_back(std::move(line));
    }
    if (!a.table.empty()) {
        const JitterTable table(standardised_delays(up));
        write_text_file(a.table, print_jitter_table(table, fmt::format("delays of {}, standardised", a.up)));
        fmt::print("{}: table of the delays, for `jitter_table` and tc\n", a.table);
    }
    if (!a.out.empty()) {
        write_text_file(a.out, schema_line() + print_profile(profile));
        fmt::print("{}: profile\n", a.out);
    }
    return static_cast<int>(ExitCode::kOk);
}

}  // namespace

NetemCommand add_fit(CLI::App& app) {
    const auto arguments = std::make_shared<FitArguments>();
    FitArguments& a = *arguments;
    CLI::App* sub =
        app.add_subcommand("fit", "make a network profile from a trace, and report how well it fits");
    sub->add_option("trace", a.up, "trace (CSV) of the up direction, or of both")->required();
    sub->add_option("--down", a.down, "trace (CSV) of the down direction; default: as the other one");
    sub->add_option("-o,--out", a.out, "profile (TOML); replaced if it exists");
    sub->add_option("--table", a.table,
                    "also write the delays as a table (.dist), for delays that fit no distribution");
    sub->footer("Example:\n  thimble-netem fit path.up.csv --down path.down.csv --out lab.toml");
    return {sub, [arguments] { return fit(*arguments); }};
}

}  // namespace thimble
