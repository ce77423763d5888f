#include "session/records/trajectory_file.hpp"

#include <array>
#include <cctype>
#include <string>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "common/csv/columns.hpp"
#include "common/csv/csv_file.hpp"
#include "common/error.hpp"
#include "common/text_file.hpp"
#include "session/records/trial_table.hpp"

namespace thimble {

namespace {

using S = TrajectorySample;

// A double takes at most 24 characters and a comma; the longest phase is "penetrated".
constexpr std::size_t kLongestLine = 7 * 25 + 16;
constexpr std::size_t kBuffer = std::size_t{1} << 16;
constexpr std::string_view kOutcome = "ended: ";

void write_phase(fmt::memory_buffer& out, const TrajectorySample& sample) {
    write_value(out, to_string(sample.phase));
}

void read_phase(const CsvField& field, TrajectorySample& sample) {
    for (const TissuePhase phase : {TissuePhase::kFree, TissuePhase::kContact, TissuePhase::kPenetrated}) {
        sample.phase = phase;
        if (field.text == to_string(phase)) return;
    }
    field.fail("is none of free, contact, penetrated");
}

constexpr std::array kSampleColumns{column<S, &S::time_s>("time_s"),
                                    column<S, &S::position_needle_m>("position_needle_m"),
                                    column<S, &S::position_surface_m>("position_surface_m"),
                                    column<S, &S::force_tissue_N>("force_tissue_N"),
                                    column<S, &S::force_fixture_N>("force_fixture_N"),
                                    column<S, &S::force_total_N>("force_total_N"),
                                    column<S, &S::contact_time_s>("contact_time_s"),
                                    TableColumn<S>{"tissue_phase", write_phase, read_phase},
                                    column<S, &S::fixture_present>("fixture_present")};
constexpr auto kSampleNames = names_of(kSampleColumns);

}  // namespace

TrajectoryWriter::TrajectoryWriter(const std::filesystem::path& path, IfExists if_exists)
    : file_(path, if_exists) {
    buffer_.reserve(kBuffer);
    if (file_.is_new()) file_.write(fmt::format("{}\n", fmt::join(kSampleNames, ",")));
}

void TrajectoryWriter::append(const TrajectorySample& sample) {
    if (kBuffer - buffer_.size() < kLongestLine) flush();
    write_fields(buffer_, kSampleColumns, sample);
    buffer_.push_back('\n');
}

void TrajectoryWriter::append(std::span<const TrajectorySample> samples) {
    for (const TrajectorySample& sample : samples) append(sample);
}

void TrajectoryWriter::flush() {
    file_.write({buffer_.data(), buffer_.size()});
    file_.flush();
    buffer_.clear();
}

void TrajectoryWriter::end(EndReason reason, Role lost_peer) {
    flush();
    file_.write(fmt::format("# {}{}\n", kOutcome, outcome_text(reason, lost_peer)));
    file_.sync();
}

std::string delay_in_names(double delay_s) { return fmt::format("{:g}ms", 1000 * delay_s); }

std::string trajectory_name(const TrialConditions& c) {
    return fmt::format("trial{:02}_{}_{}.csv", c.trial, to_string(c.modality), delay_in_names(c.delay_s));
}

std::filesystem::path find_trajectory(const std::filesystem::path& folder, const TrialConditions& c) {
    const std::string name = trajectory_name(c);
    std::error_code absent;
    // The name that a study gives says more: it comes first where a folder has files of a run as well.
    for (const auto& file :
         {folder / fmt::format("experiment{}_subject{:02}_{}", c.experiment, c.subject, name),
          folder / name}) {
        if (std::filesystem::exists(file, absent)) return file;
    }
    return {};
}

void remove_trajectories(const std::filesystem::path& folder) {
    std::error_code absent;
    std::vector<std::filesystem::path> ours;
    for (const auto& file : std::filesystem::directory_iterator(folder, absent)) {
        const std::string name = file.path().filename().string();
        for (const std::string_view begin : {"experiment", "trial"}) {
            if (name.starts_with(begin) && name.ends_with(".csv") &&
                std::isdigit(static_cast<unsigned char>(name[begin.size()])) != 0)
                ours.push_back(file.path());
        }
    }
    for (const auto& file : ours) remove_file(file);
}

Trajectory read_trajectory(const std::filesystem::path& path, LastLine last) {
    CsvReader reader(path, kSampleNames, ',', 0, last);
    Trajectory trajectory;
    while (reader.next()) {
        if (!reader.comments().empty()) reader.field(0).fail("comes after the trial's end");
        read_fields(reader, kSampleColumns, trajectory.samples.emplace_back());
    }
    if (reader.comments().empty()) return trajectory;
    std::string_view ended = reader.comments().back();
    if (ended.starts_with(kOutcome)) ended.remove_prefix(kOutcome.size());
    if (!parse_outcome(ended, trajectory.reason, trajectory.lost_peer)) {
        throw Error(ExitCode::kData, "{}: the last line says '{}' instead of '# {}<outcome>'", path.string(),
                    reader.comments().back(), kOutcome);
    }
    return trajectory;
}

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
            reader.field(1).fail("is not a known event: delay_s, profile");
        }
        events.push_back(std::move(event));
    }
    return events;
}

}  // namespace thimble
