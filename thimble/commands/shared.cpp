#include "thimble/commands/shared.hpp"

#include <cstdint>
#include <fstream>
#include <iostream>
#include <limits>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "analysis/findings.hpp"
#include "common/decimal_text.hpp"
#include "common/error.hpp"
#include "common/text_file.hpp"

namespace thimble {

void add_base_port_option(CLI::App& command, int& base_port) {
    command.add_option("--base-port", base_port, "first UDP port, instead of [network] base_port")
        ->check(CLI::Range(1024, 65536 - static_cast<int>(Port::kCount)))
        ->type_name("PORT");
}

NetworkSettings network_of(const std::string& session_file, int base_port) {
    NetworkSettings network =
        read_network_settings(session_file.empty() ? ConfigFile::empty() : ConfigFile::load(session_file));
    if (base_port != 0) network.base_port = static_cast<std::uint16_t>(base_port);
    return network;
}

std::filesystem::path output_file(const std::filesystem::path& out, const char* name) {
    const auto end = out.extension(), wanted = std::filesystem::path(name).extension();
    std::error_code unknown;
    const auto there = std::filesystem::status(out, unknown);
    // /dev/stdout may be a file, /dev/shm holds folders.
    const bool stream = std::filesystem::is_other(there) || std::filesystem::is_character_file(there) ||
                        std::filesystem::is_fifo(there) || out.parent_path() == "/dev";
    if (!stream && end != wanted && (end == ".csv" || end == ".json" || end == ".html"))
        throw Error(ExitCode::kUsage, "--out {}: name a folder, or a file that ends in {}", out.string(),
                    wanted.string());
    const bool file = (stream && !std::filesystem::is_directory(there)) || end == wanted;
    make_folder(file ? out.parent_path() : out);
    return file ? out : out / name;
}

// Looks for the session file last: with a misspelt option this argument gets the option's value, and the option is
// the error to report.
CLI::Option* add_session_option(CLI::App& command, std::string& file, const std::string& help) {
    CLI::Option* option = command.add_option("session", file, help)->type_name("FILE|NAME");
    command.final_callback([option, &file] {
        if (option->count() > 0) file = find_session_file(file).string();
    });
    return option;
}

CLI::Option* as_session_seed(CLI::Option* option) {
    return option->check([](const std::string& typed) {
        constexpr std::uint64_t kMost = std::numeric_limits<std::int64_t>::max();
        const bool too_large = parse_whole<std::uint64_t>(typed).value_or(0) > kMost;
        return too_large ? fmt::format("'{}': a session's seed is at most {}", typed, kMost) : std::string();
    });
}

void say_results(bool json, const std::filesystem::path& folder, const std::vector<TrialRow>& rows) {
    std::ifstream summary(folder / "summary.json");
    if (!summary) return;  // no trial is done, so there is no report
    if (json) {
        std::cout << summary.rdbuf();
        return;
    }
    for (const std::string& sentence : answer(findings_of(rows))) fmt::print("{}\n", sentence);
    fmt::print("results: {}\n", (folder / "report.html").string());
}

}  // namespace thimble
