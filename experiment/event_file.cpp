#include "experiment/event_file.hpp"

#include <array>

#include <fmt/format.h>

#include "experiment/csv.hpp"
#include "experiment/csv_file.hpp"

namespace thimble {
namespace {

constexpr std::array<std::string_view, 3> kEventColumns{"time_s", "event", "value"};
constexpr std::string_view kDelayEvent = "delay_s";

}  // namespace

std::filesystem::path event_path(const std::filesystem::path& trajectory) {
    std::filesystem::path path = trajectory;
    return path.replace_extension(".events.csv");
}

void write_events(const std::filesystem::path& path, const std::vector<DelayChange>& changes) {
    CsvFile file(path, IfExists::kReplace);
    file.write(fmt::format("{}\n", fmt::join(kEventColumns, ",")));
    for (const DelayChange& change : changes) {
        file.write(fmt::format("{},{},{}\n", change.time_s, kDelayEvent, change.delay_s));
    }
    file.sync();
}

std::vector<DelayChange> read_events(const std::filesystem::path& path) {
    CsvReader reader(path, kEventColumns);
    std::vector<DelayChange> changes;
    while (reader.next()) {
        if (reader.field(1).text != kDelayEvent) reader.field(1).fail("is no event known here: delay_s");
        changes.push_back({reader.field(0).number(), reader.field(2).number()});
    }
    return changes;
}

}  // namespace thimble
