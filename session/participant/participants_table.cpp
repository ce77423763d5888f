#include "session/participant/participants_table.hpp"

#include <array>
#include <charconv>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "session/participant/tsv.hpp"

namespace thimble {
namespace {

constexpr std::array<std::string_view, 8> kPersonColumns{
    "participant_id", "species", "age", "sex", "handedness", "haptic_experience", "subject_kind", "consent"};

std::vector<std::string> line_of(std::uint32_t participant, SubjectKind kind, const PersonDescription& p) {
    const bool human = kind == SubjectKind::kHuman;
    const std::string none(kNotAvailable);
    return {participant_id(participant),
            human ? "homo sapiens" : none,  // where it is missing, BIDS takes everybody for a human
            human ? p.age : none,
            human ? p.sex : none,
            human ? p.handedness : none,
            human ? p.haptic_experience : none,
            to_string(kind),
            human && p.consent ? "yes" : none};
}

}  // namespace

std::string age_text(const std::string& years) {
    int age = 0;
    const char* const end = years.data() + years.size();
    const auto [rest, error] = std::from_chars(years.data(), end, age);
    if (years == kNotAvailable) return years;
    if (error != std::errc{} || rest != end || age < 1 || age > 120) {
        throw Error(ExitCode::kUsage, fmt::format("--age {}: must be whole years, 1 to 120, or n/a", years));
    }
    return age >= 89 ? "89+" : std::to_string(age);
}

std::string add_participant(const Dataset& dataset, std::uint32_t participant, SubjectKind kind,
                            const PersonDescription& person) {
    const std::vector<std::string> ours = line_of(participant, kind, person);
    TsvFile table(dataset.participants(), kPersonColumns);
    CsvReader reader(dataset.participants(), kPersonColumns, '\t');
    while (reader.next()) {
        if (parse_participant(reader.field(0).text) != participant) continue;
        std::vector<std::string> there;
        for (std::size_t i = 0; i < kPersonColumns.size(); ++i) there.emplace_back(reader.field(i).text);
        return there == ours ? std::string() : fmt::format("{}", fmt::join(there, ", "));
    }
    table.append(ours);
    return {};
}

std::vector<std::uint32_t> read_participants(const Dataset& dataset) {
    std::vector<std::uint32_t> all;
    if (!is_table(dataset.participants())) return all;
    CsvReader reader(dataset.participants(), kPersonColumns, '\t');
    while (reader.next()) {
        const auto participant = parse_participant(reader.field(0).text);
        if (!participant) reader.field(0).fail("is no participant, e.g. sub-07");
        all.push_back(*participant);
    }
    return all;
}

}  // namespace thimble
