// thimble log: what stands in the logs of messages, and what can be done with them.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/runtime/standard_streams.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/log/log_export.hpp"
#include "thimble/log/log_tools.hpp"

namespace thimble {
namespace {

struct LogArguments {
    std::vector<std::string> files;
    std::string out, topic, csv, json, hdf5, ros2;
    int (*run)(const LogArguments&) = nullptr;  // of the part that was given
};

void put(const std::string& line) {
    if (std::fwrite(line.data(), 1, line.size(), stdout) != line.size()) throw ResultsLost();
}

// Not between the messages, where they go to standard output.
void say(const LogArguments& a, const std::string& line) {
    if (a.json == "-") {
        spdlog::info(line);
    } else {
        fmt::print("{}\n", line);
    }
}

int show_info(const LogArguments& a) {
    for (const auto& file : open_logs(a.files)) fmt::print("{}", describe_log(*file));
    return 0;
}

void each_merged(const LogArguments& a, const LoggedFiles& files,
                 const std::function<void(const MergedMessage&)>& use) {
    for (const MergedMessage& message : merge_logs(files)) {
        if (message.topic->topic.starts_with(a.topic)) use(message);
    }
}

int show_messages(const LogArguments& a) {
    const LoggedFiles files = open_logs(a.files);
    const PacketFields fields;
    std::int64_t zero_ns = INT64_MIN;
    each_merged(a, files, [&](const MergedMessage& message) {
        if (zero_ns == INT64_MIN) zero_ns = message.session_time_ns;
        put(to_line(message, fields, zero_ns) + '\n');
    });
    return 0;
}

// Of the session whose logs these are; none if they are of several, or it is not beside them.
std::filesystem::path relay_report_beside(const LoggedFiles& files) {
    const auto report_of = [](const LoggedFile& file) {
        const std::string name = file.path().stem().string();
        const auto condition = name.rfind('_');
        if (condition == std::string::npos) return std::filesystem::path{};
        return file.path().parent_path() / ("thimble-netem" + name.substr(condition) + ".json");
    };
    const std::filesystem::path report = report_of(*files.front());
    const bool one_session =
        std::all_of(files.begin(), files.end(), [&](const auto& file) { return report_of(*file) == report; });
    return one_session && std::filesystem::exists(report) ? report : std::filesystem::path{};
}

bool check_with_relay(const std::vector<FlowFinding>& flows, const LoggedFiles& files) {
    const std::filesystem::path report = relay_report_beside(files);
    if (report.empty()) return true;
    const bool whole = std::all_of(files.begin(), files.end(), [](const auto& file) {
        return file->scan().finished && file->lost() == 0;
    });
    if (!whole) {
        fmt::print("not compared with {}: messages or a log of one end are missing\n", report.string());
        return true;
    }
    bool good = true;
    for (const RelayFinding& f : check_relay(flows, report)) {
        fmt::print(
            "{}: {} lost according to the logs, {} according to the relay{}; before it {}, inside {}, after "
            "it {}{}\n",
            f.topic, f.lost, f.named, f.names.empty() ? "" : fmt::format(" ({})", f.names), f.before,
            f.within, f.behind, f.problem.empty() ? "" : "; NOT EXPLAINED: " + f.problem);
        good = good && f.problem.empty();
    }
    return good;
}

int check_logs(const LogArguments& a) {
    const LoggedFiles files = open_logs(a.files);
    bool good = true;
    for (const auto& file : files) {
        const FileFinding finding = check_file(*file);
        fmt::print("{}: {} messages, {}\n", file->path().string(), file->scan().messages,
                   finding.problems.empty() ? "good" : "not good");
        for (const std::string& problem : finding.problems) fmt::print("  {}\n", problem);
        good = good && finding.problems.empty();
    }
    const std::vector<FlowFinding> flows = check_flows(files);
    for (const FlowFinding& f : flows) {
        fmt::print("{}: {} sent = {} received + {} lost{}; {} repeated, {} out of order{}\n", f.topic, f.sent,
                   f.received, f.lost,
                   f.outside > 0 ? fmt::format(" + {} before or after the receiver's log", f.outside) : "",
                   f.repeated, f.out_of_order,
                   f.foreign > 0 ? fmt::format("; {} RECEIVED BUT NEVER SENT", f.foreign) : "");
        good = good && f.foreign == 0;
    }
    good = check_with_relay(flows, files) && good;
    return static_cast<int>(good ? ExitCode::kOk : ExitCode::kData);
}

int repair(const LogArguments& a) {
    const RepairResult result = repair_log(a.files.front(), a.out);
    fmt::print(
        "{}: kept {} messages, {} of them from an unfinished chunk; left out {} bytes after the last whole "
        "record and {} damaged parts\n",
        a.out, result.messages, result.scan.recovered, result.bytes_cut, result.scan.damaged);
    return 0;
}

void export_json(const LogArguments& a, const LoggedFiles& files) {
    const bool to_stdout = a.json == "-";
    const std::unique_ptr<CsvFile> file =
        to_stdout ? nullptr : std::make_unique<CsvFile>(a.json, IfExists::kRefuse);
    const PacketFields fields;
    each_merged(a, files, [&](const MergedMessage& message) {
        const std::string line = to_json(message, fields) + '\n';
        if (file) {
            file->write(line);
        } else {
            put(line);
        }
    });
    if (file) file->flush();
}

void share_ros2(const LogArguments& a, const LoggedFiles& files) {
    const Ros2Written written = export_ros2(files, a.ros2, a.topic);
    say(a, fmt::format("{}: {} topics", a.ros2, written.topics));
    if (written.missing.empty()) return;
    std::string words;
    for (const std::string& part : written.missing) words += "\n  " + part;
    const std::string_view advice =
        written.events_only
            ? "The logs hold requests only: [log] messages = \"control\", the default, records no more: set "
              "\"all\" in the session file, run it again, and give the logs of all its programs."
            : "Give the logs of all programs of one delay, recorded with [log] messages = \"all\".";
    spdlog::warn(
        "{}: the logs hold none of these:{}\n"
        "{}",
        a.ros2, words, advice);
}

int share(const LogArguments& a) {
    if (a.csv.empty() && a.json.empty() && a.hdf5.empty() && a.ros2.empty())
        throw Error(ExitCode::kUsage,
                    "name the output: --csv FOLDER, --hdf5 FILE, --json FILE or --ros2 FILE");
    const LoggedFiles files = open_logs(a.files);
    if (!a.json.empty() || !a.ros2.empty()) require_one_trial(files);  // before anything is written
    if (!a.csv.empty()) say(a, fmt::format("{}: {} tables", a.csv, export_csv(files, a.csv, a.topic)));
    if (!a.hdf5.empty()) say(a, fmt::format("{}: {} tables", a.hdf5, export_hdf5(files, a.hdf5, a.topic)));
    if (!a.json.empty()) export_json(a, files);
    if (!a.ros2.empty()) share_ros2(a, files);
    return 0;
}

int print_dissector(const LogArguments& /*a*/) {
    put(wireshark_dissector());
    return 0;
}

CLI::App* add_part(CLI::App& log, LogArguments& a, int (*run)(const LogArguments&), const char* name,
                   const char* what, const char* example) {
    CLI::App* part = log.add_subcommand(name, what);
    part->add_option("files", a.files,
                     "log files (.mcap); several programs of one session may be given together")
        ->required();
    part->footer(std::string("Example:\n  ") + example);
    part->callback([&a, run] { a.run = run; });
    return part;
}

}  // namespace

Subcommand add_log(CLI::App& app) {
    const auto arguments = std::make_shared<LogArguments>();
    LogArguments& a = *arguments;
    CLI::App* log = app.add_subcommand("log", "show, check, repair and export the message logs of a run");
    log->require_subcommand(1);
    log->footer(
        "Examples:\n  thimble log info out/run/nodes/session_50ms.mcap\n  thimble log check "
        "out/run/nodes/*_50ms.mcap\n\n"
        "Exit codes: 0 good, 1 not written, 2 usage, 5 a log cannot be read or trusted.");
    add_part(*log, a, show_info, "info", "show the contents of a log: programs, topics, counts, times",
             "thimble log info out/run/nodes/session_50ms.mcap");
    CLI::App* cat = add_part(*log, a, show_messages, "cat",
                             "print one line per message, in the order of the session's clock",
                             "thimble log cat out/run/nodes/*_50ms.mcap --topic /master/needle_command");
    add_part(*log, a, check_logs, "check",
             "check checksums, times and sequence numbers; the logs of sender and receiver together also "
             "show lost messages",
             "thimble log check out/run/nodes/*_50ms.mcap");
    CLI::App* fix =
        add_part(*log, a, repair, "repair", "make a readable log with an index from a log that was cut off",
                 "thimble log repair out/run/nodes/session_50ms.mcap --out whole.mcap");
    CLI::App* to_others =
        add_part(*log, a, share, "export", "export tables, JSON or ROS 2 messages for other programs",
                 "thimble log export out/run/nodes/*_50ms.mcap --csv out/tables");
    log->add_subcommand("dissector",
                        "print a Wireshark dissector for unprotected datagrams (docs/interoperability.md)")
        ->callback([&a] { a.run = print_dissector; });
    fix->get_option("files")->expected(1);
    fix->add_option("-o,--out", a.out, "new file")->required();
    for (CLI::App* part : {cat, to_others})
        part->add_option("--topic", a.topic, "only topics that begin with this text");
    to_others->add_option("--csv", a.csv, "folder for CSV tables: one per log, topic and kind of message");
    to_others->add_option("--hdf5", a.hdf5, "new HDF5 file with the same tables and their units");
    to_others->add_option("--json", a.json, "JSON file with one message per line; - writes to stdout");
    to_others->add_option("--ros2", a.ros2,
                          "new MCAP file of ROS 2 messages, for ros2 bag, PlotJuggler, Foxglove or MATLAB "
                          "(docs/interoperability.md)");
    return {log, [arguments] { return arguments->run(*arguments); }};
}

}  // namespace thimble
