#include "session/records/event_file.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "common/csv/csv.hpp"
#include "common/csv/csv_file.hpp"

namespace thimble {
namespace {

constexpr std::array<std::string_view, 3> kEventColumns{"time_s", "event", "value"};
constexpr std::string_view kProfileEvent = "profile", kDelayEvent = "delay_s";

// The numbers of a profile, in the order of their lines.
struct ProfileNumber {
    std::string_view name;
    double& (*in)(NetworkEvent& event);
};
constexpr std::array<ProfileNumber, 6> kProfileNumbers{{
    {kDelayEvent, [](NetworkEvent& e) -> double& { return e.force.delay_s; }},
    {"jitter_spread_s", [](NetworkEvent& e) -> double& { return e.force.jitter_spread_s; }},
    {"loss", [](NetworkEvent& e) -> double& { return e.force.loss; }},
    {"needle_delay_s", [](NetworkEvent& e) -> double& { return e.needle.delay_s; }},
    {"needle_jitter_spread_s", [](NetworkEvent& e) -> double& { return e.needle.jitter_spread_s; }},
    {"needle_loss", [](NetworkEvent& e) -> double& { return e.needle.loss; }},
}};

// By value: the numbers are reached as ones that could be written to.
std::string lines_of(NetworkEvent event) {
    if (event.profile.empty()) return fmt::format("{},{},{}\n", event.time_s, kDelayEvent, event.delay_s);
    std::string lines = fmt::format("{},{},{}\n", event.time_s, kProfileEvent, event.profile);
    for (const ProfileNumber& number : kProfileNumbers)
        lines += fmt::format("{},{},{}\n", event.time_s, number.name, number.in(event));
    return lines;
}

// An event without one of its numbers is damaged, unlike a trial without a measure.
double number_in(const CsvField& field) {
    if (field.text.empty()) field.fail("is not a number");
    return field.number();
}

void read_profile(CsvReader& reader, NetworkEvent& event) {
    const CsvField begin = reader.field(1);
    for (const ProfileNumber& number : kProfileNumbers) {
        if (!reader.next()) begin.fail(fmt::format("is not followed by its {}", number.name));
        if (reader.field(1).text != number.name)
            reader.field(1).fail(fmt::format("is not the profile's {}, which comes next", number.name));
        number.in(event) = number_in(reader.field(2));
    }
    event.delay_s = event.force.delay_s;
}

}  // namespace

std::filesystem::path event_path(const std::filesystem::path& trajectory) {
    std::filesystem::path path = trajectory;
    return path.replace_extension(".events.csv");
}

void write_events(const std::filesystem::path& path, const std::vector<NetworkEvent>& events) {
    CsvFile file(path, IfExists::kReplace);
    file.write(fmt::format("{}\n", fmt::join(kEventColumns, ",")));
    for (const NetworkEvent& event : events) file.write(lines_of(event));
    file.sync();
}

std::vector<NetworkEvent> read_events(const std::filesystem::path& path) {
    CsvReader reader(path, kEventColumns);
    std::vector<NetworkEvent> events;
    while (reader.next()) {
        NetworkEvent event;
        event.time_s = number_in(reader.field(0));
        if (reader.field(1).text == kProfileEvent) {
            event.profile = reader.field(2).text;
            if (event.profile.empty()) reader.field(2).fail("is not the name of a profile");
            read_profile(reader, event);
        } else if (reader.field(1).text == kDelayEvent) {
            event.delay_s = number_in(reader.field(2));
        } else {
            reader.field(1).fail("is no event known here: delay_s, profile");
        }
        events.push_back(std::move(event));
    }
    return events;
}

}  // namespace thimble
