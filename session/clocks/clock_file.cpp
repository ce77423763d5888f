#include "session/clocks/clock_file.hpp"

#include <array>
#include <string_view>

#include <fmt/format.h>

#include "common/csv/csv.hpp"

namespace thimble {
namespace {

constexpr std::array<std::string_view, 7> kClockColumns{
    "node", "sent_ns", "arrived_node_ns", "replied_node_ns", "answered_ns", "offset_s", "bound_s"};
constexpr std::uint64_t kMostStamp_ns = std::uint64_t{1} << 62;

Role read_role(const CsvField& field) {
    for (const Role role : {Role::kMaster, Role::kSlaveSim, Role::kCutaneous, Role::kVisual, Role::kNetem}) {
        if (field.text == to_string(role)) return role;
    }
    field.fail("is the name of no node");
}

SessionTime read_stamp(const CsvField& field) {
    return from_nanoseconds(static_cast<std::int64_t>(field.integer(kMostStamp_ns)));
}

}  // namespace

ClockWriter::ClockWriter(const std::filesystem::path& path) : file_(path, IfExists::kReplace) {
    file_.write(fmt::format("{}\n", fmt::join(kClockColumns, ",")));
}

void ClockWriter::append(Role node, const ClockExchange& e) {
    fmt::memory_buffer line;  // on the stack
    fmt::format_to(std::back_inserter(line), "{},{},{},{},{},{},{}\n", to_string(node),
                   to_nanoseconds(e.sent), to_nanoseconds(e.arrived), to_nanoseconds(e.replied),
                   to_nanoseconds(e.answered), e.offset_s(), e.bound_s());
    file_.write({line.data(), line.size()});
}

std::vector<ClockRecord> read_clock_file(const std::filesystem::path& path) {
    CsvReader reader(path, kClockColumns);
    std::vector<ClockRecord> records;
    while (reader.next()) {
        records.push_back({read_role(reader.field(0)),
                           {read_stamp(reader.field(1)), read_stamp(reader.field(2)),
                            read_stamp(reader.field(3)), read_stamp(reader.field(4))}});
        if (!records.back().exchange.possible())
            reader.field(4).fail("makes an exchange that no two clocks can have had");
    }
    return records;
}

}  // namespace thimble
