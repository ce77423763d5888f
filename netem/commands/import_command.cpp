// thimble-netem import: what a measuring program wrote becomes a trace.
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/error.hpp"
#include "common/text_file.hpp"
#include "netem/commands/commands.hpp"
#include "netem/formats/trace_files.hpp"
#include "netem/import/importers.hpp"

namespace thimble {
namespace {

struct ImportArguments {
    std::vector<std::string> files;  // one of irtt or ping, or two captures: sender's, receiver's
    std::string out;
    std::string format = "auto";     // irtt, ping, pcap; auto: by what the first file begins with
    std::string direction = "both";  // of irtt: up, down; both: OUT.up.csv and OUT.down.csv
    double interval_s = 1;           // of ping without time stamps
    int sent_port = 0, received_port = 0;
    double least_delay_s = -1;  // below 0: as the stamps are
};

// pcapng, and pcap in microseconds and nanoseconds, in either order of bytes.
constexpr std::array<std::string_view, 5> kCaptureBegins{
    "\x0a\x0d\x0d\x0a", "\xd4\xc3\xb2\xa1", "\xa1\xb2\xc3\xd4", "\x4d\x3c\xb2\xa1", "\xa1\xb2\x3c\x4d"};

std::string format_of(std::string_view text) {
    for (const std::string_view begin : kCaptureBegins) {
        if (text.starts_with(begin)) return "pcap";
    }
    const std::size_t visible = text.find_first_not_of(" \t\r\n");
    return visible != std::string_view::npos && text[visible] == '{' ? "irtt" : "ping";
}

void write(const MeasuredPath& path, const std::string& file) {
    write_text_file(file, print_path(path));
    std::size_t lost = 0;
    for (const MeasuredPacket& packet : path.packets) lost += packet.loss >= 1 ? 1 : 0;
    fmt::print("{}: {} packets over {:.3f} s, {} of them lost\n", file, path.packets.size(),
               static_cast<double>(path.packets.back().at) * 1e-9, lost);
    for (const std::string& remark : path.remarks) fmt::print("  {}\n", remark);
}

std::string with_direction(const std::string& file, const char* direction) {
    std::filesystem::path path(file);
    return path.replace_extension(direction + path.extension().string()).string();
}

void import_irtt(const std::string& text, const ImportArguments& a) {
    const MeasuredPaths paths = parse_irtt(text, a.files[0]);
    const bool both = a.direction == "both";
    if (a.direction != "down") write(paths.up, both ? with_direction(a.out, "up") : a.out);
    if (a.direction != "up") write(paths.down, both ? with_direction(a.out, "down") : a.out);
}

std::optional<std::uint16_t> port_of(int port) {
    return port > 0 ? std::optional(static_cast<std::uint16_t>(port)) : std::nullopt;
}

void import_captures(const std::string& text, const ImportArguments& a) {
    if (a.files.size() != 2) {
        throw Error(ExitCode::kUsage, "import: captures need two files, the sender's and the receiver's");
    }
    const Capture sent = parse_capture(text, a.files[0]);
    const Capture received = parse_capture(read_whole_file(a.files[1]), a.files[1]);
    CapturePairOptions options{port_of(a.sent_port), port_of(a.received_port), {}};
    if (a.least_delay_s >= 0) options.least_delay = from_seconds(a.least_delay_s);
    const CapturePair pair = match_captures(sent, received, options);
    write(pair.path, a.out);
    fmt::print(
        "  {} duplicates, {} out of order, {} received that were never sent; delays by the time stamps "
        "{:.6f} to {:.6f} s\n",
        pair.duplicates, pair.reordered, pair.foreign, to_seconds(pair.least), to_seconds(pair.most));
    for (const Capture* capture : {&sent, &received}) {
        if (capture->fragments + capture->others == 0 && !capture->cut_at_end) continue;
        fmt::print("  {}: left out {} packets that are not UDP and {} fragments{}\n",
                   capture == &sent ? a.files[0] : a.files[1], capture->others, capture->fragments,
                   capture->cut_at_end ? "; it ends within a packet" : "");
    }
}

struct OptionOfFormat {
    const char* option;
    std::string_view format;
};
constexpr std::array<OptionOfFormat, 5> kOptionsOfFormats{{{"--direction", "irtt"},
                                                           {"--interval-s", "ping"},
                                                           {"--sent-port", "pcap"},
                                                           {"--received-port", "pcap"},
                                                           {"--least-delay-s", "pcap"}}};

void refuse_options_of_others(const CLI::App& command, std::string_view format, const std::string& file) {
    for (const auto& [option, own] : kOptionsOfFormats) {
        if (own == format || command.get_option(option)->count() == 0) continue;
        throw Error(ExitCode::kUsage, "import: {} is for {} only, but {} is read as {}: leave it out", option,
                    own, file, format);
    }
}

std::vector<std::string> outputs_of(const std::string& format, const ImportArguments& a) {
    if (format != "irtt" || a.direction != "both") return {a.out};
    return {with_direction(a.out, "up"), with_direction(a.out, "down")};
}

// Writes the trace, says on stdout what is in it.
int import_files(const CLI::App& command, const ImportArguments& arguments) {
    const std::string text = read_whole_file(arguments.files.at(0));
    const std::string format = arguments.format == "auto" ? format_of(text) : arguments.format;
    refuse_options_of_others(command, format, arguments.files[0]);
    refuse_same_file(arguments.files, outputs_of(format, arguments));
    if (format == "pcap") {
        import_captures(text, arguments);
    } else if (arguments.files.size() > 1) {
        throw Error(ExitCode::kUsage,
                    "import: give one file of irtt or ping at a time; only captures (pcap) need two");
    } else if (format == "irtt") {
        import_irtt(text, arguments);
    } else {
        write(parse_ping(text, arguments.files[0], from_seconds(arguments.interval_s)), arguments.out);
    }
    return static_cast<int>(ExitCode::kOk);
}

// Of files that are not there yet the names tell.
bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
    std::error_code unknown;
    if (std::filesystem::exists(a, unknown)) return std::filesystem::equivalent(a, b, unknown);
    return std::filesystem::absolute(a).lexically_normal() == std::filesystem::absolute(b).lexically_normal();
}

}  // namespace

void refuse_same_file(const std::vector<std::string>& read, const std::vector<std::string>& written) {
    std::vector<std::string> others = read;
    for (const std::string& file : written) {
        if (file.empty()) continue;
        for (const std::string& other : others) {
            if (!other.empty() && is_same_file(file, other))
                throw Error(ExitCode::kUsage,
                            "{} is named twice: name other files to write than those to read", file);
        }
        others.push_back(file);
    }
}

NetemCommand add_import(CLI::App& app) {
    const auto arguments = std::make_shared<ImportArguments>();
    ImportArguments& a = *arguments;
    CLI::App* sub =
        app.add_subcommand("import", "make a trace from irtt's JSON, ping's output or two packet captures");
    sub->add_option("files", a.files,
                    "irtt's JSON, ping's output, or the captures (pcap) of sender and receiver")
        ->required()
        ->expected(1, 2);
    sub->add_option("-o,--out", a.out, "trace (CSV); replaced if it exists")->required();
    sub->add_option("--format", a.format, "format of the files")
        ->default_val(a.format)
        ->check(CLI::IsMember({"auto", "irtt", "ping", "pcap"}));
    sub->add_option("--direction", a.direction,
                    "direction of irtt's packets; both: OUT.up.csv and OUT.down.csv")
        ->default_val(a.direction)
        ->check(CLI::IsMember({"up", "down", "both"}));
    sub->add_option("--interval-s", a.interval_s, "time between two packets of ping without -D, s")
        ->default_val(a.interval_s)
        ->check(CLI::Range(1e-4, 3600.0));
    sub->add_option("--sent-port", a.sent_port, "only datagrams to this port, in the sender's capture")
        ->check(CLI::Range(1, 65535));
    sub->add_option("--received-port", a.received_port,
                    "only datagrams to this port, in the receiver's capture")
        ->check(CLI::Range(1, 65535));
    sub->add_option(
           "--least-delay-s", a.least_delay_s,
           "shift all delays so that the shortest is this one, s, if the clocks are not synchronised")
        ->check(CLI::Range(0.0, 60.0));
    sub->footer(
        "Examples:\n  thimble-netem import irtt.json --out path.csv\n"
        "  thimble-netem import sent.pcap received.pcap --sent-port 9000 --out path.csv");
    return {sub, [sub, arguments] { return import_files(*sub, *arguments); }};
}

}  // namespace thimble
