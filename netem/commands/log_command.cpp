// thimble-netem log: prints a packet log as CSV.
#include <array>
#include <fstream>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/error.hpp"
#include "common/text_file.hpp"
#include "netem/commands/commands.hpp"
#include "netem/relay/packet_record.hpp"

namespace thimble {
namespace {

template <std::size_t kSize>
std::size_t read_some(std::istream& file, const std::string& path, std::array<std::uint8_t, kSize>& bytes) {
    file.read(reinterpret_cast<char*>(bytes.data()), kSize);
    refuse_half_read(file, path);
    return static_cast<std::size_t>(file.gcount());
}

int print_log(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw Error(ExitCode::kData, "cannot read '{}': does it exist?", path);
    std::array<std::uint8_t, kLogHeaderBytes> header{};
    check_log_header({header.data(), read_some(file, path, header)}, path);
    fmt::print("{}\n", record_csv_header());
    std::array<std::uint8_t, kRecordBytes> bytes{};
    for (std::uint64_t i = 0;; ++i) {
        const std::size_t size = read_some(file, path, bytes);
        if (size == 0) return 0;
        const auto record = size == kRecordBytes ? decode_record(bytes) : std::nullopt;
        if (!record) {
            throw Error(ExitCode::kData, "'{}': stopped at record {} of the log, which is {}", path, i,
                        size < kRecordBytes ? "cut short" : "damaged");
        }
        fmt::print("{}\n", to_csv(*record));
    }
}

}  // namespace

NetemCommand add_log(CLI::App& app) {
    const auto path = std::make_shared<std::string>();
    CLI::App* command = app.add_subcommand("log", "print a packet log as CSV");
    command->add_option("file", *path, "packet log, written by --log")->required();
    command->footer("Example:\n  thimble-netem log packets.bin > packets.csv");
    return {command, [path] { return print_log(*path); }};
}

}  // namespace thimble
