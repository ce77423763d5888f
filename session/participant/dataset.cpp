#include "session/participant/dataset.hpp"

#include <algorithm>
#include <array>
#include <fstream>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "common/decimal_text.hpp"
#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/text_file.hpp"
#include "common/version.hpp"
#include "session/participant/tsv.hpp"

namespace thimble {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kKindKey = "SubjectKind";

std::string description_text(SubjectKind kind, const DatasetSettings& settings) {
    Json json{{"Name", settings.name}, {"BIDSVersion", "1.8.0"}, {"DatasetType", "raw"}};
    if (!settings.license.empty()) json["License"] = settings.license;
    if (!settings.authors.empty()) json["Authors"] = settings.authors;
    if (!settings.ethics_approvals.empty()) json["EthicsApprovals"] = settings.ethics_approvals;
    json["GeneratedBy"] = Json::array({Json{{"Name", "Thimble"}, {"Version", kVersion}}});
    json[kKindKey] = to_string(kind);
    return json_text(json, 2) + '\n';
}

// But for what a crash left of open(): whole sidecars, and a file half written.
bool holds_nothing(const std::filesystem::path& folder, const std::filesystem::path& description,
                   const std::vector<Sidecar>& sidecars) {
    const auto ours = [&](const std::filesystem::directory_entry& entry) {
        return entry.path() == description.string() + ".new" ||
               std::any_of(sidecars.begin(), sidecars.end(), [&](const Sidecar& sidecar) {
                   const auto file = folder / sidecar.file;
                   return entry.path() == file.string() + ".new" ||
                          (entry.path() == file && read_text_file(file) == sidecar.text);
               });
    };
    std::error_code absent;
    const std::filesystem::directory_iterator entries(folder, absent);
    return std::all_of(begin(entries), end(entries), ours);
}

}  // namespace

std::filesystem::path Dataset::order(std::uint32_t participant) const {
    return folder_ / "orders" / (participant_id(participant) + "_order.tsv");
}

std::filesystem::path Dataset::records(std::uint32_t participant) const {
    const std::string id = participant_id(participant);
    return folder_ / id / "beh" / (id + "_task-needle_beh.tsv");
}

std::filesystem::path Dataset::source(std::uint32_t participant) const {
    return folder_ / "sourcedata" / participant_id(participant);
}

std::optional<SubjectKind> Dataset::kind() const {
    std::error_code absent;
    if (!std::filesystem::exists(description(), absent)) return std::nullopt;
    std::ifstream file(description());
    const Json json = Json::parse(file, nullptr, false);
    const bool has_kind = json.is_object() && json.contains(kKindKey) && json[kKindKey].is_string();
    const auto kind = has_kind ? parse_subject_kind(json[kKindKey].get<std::string>()) : std::nullopt;
    if (!kind) {
        throw Error(ExitCode::kData,
                    "{}: does not say whether its subjects are virtual or human (key \"{}\"): it is not a "
                    "Thimble dataset, or it was changed; restore it",
                    description().string(), kKindKey);
    }
    return kind;
}

void Dataset::open(SubjectKind wanted, const DatasetSettings& settings) const {
    if (const auto found = kind()) {
        if (*found == wanted) return;
        throw Error(ExitCode::kUsage,
                    "{}: holds data of {} subjects, and virtual and human subjects never share a folder; "
                    "name another one with --out",
                    folder_.string(), to_string(*found));
    }
    const std::vector<Sidecar> sidecars = sidecars_of(wanted, settings.name);
    if (!holds_nothing(folder_, description(), sidecars)) {
        throw Error(ExitCode::kUsage,
                    "{}: holds files that are not a dataset of participants; name a new or an empty folder "
                    "with --out",
                    folder_.string());
    }
    make_folder(folder_);
    for (const Sidecar& sidecar : sidecars) write_whole(folder_ / sidecar.file, sidecar.text);
    // Last: it makes the folder a dataset, and a crash may come before it.
    write_whole(description(), description_text(wanted, settings));
}

void refuse_dataset(const std::filesystem::path& folder) {
    const auto kind = Dataset(folder).kind();
    if (!kind) return;
    throw Error(ExitCode::kUsage,
                "{}: holds a dataset of {} participants, and no other data can be written there; name "
                "another folder with --out",
                folder.string(), to_string(*kind));
}

namespace {

constexpr std::array<std::string_view, 8> kPersonColumns{
    "participant_id", "species", "age", "sex", "handedness", "haptic_experience", "subject_kind", "consent"};

std::string line_of(std::uint32_t participant, SubjectKind kind, const PersonDescription& p) {
    const bool human = kind == SubjectKind::kHuman;
    const std::string none(kNotAvailable);
    return fmt::format("{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}", participant_id(participant),
                       human ? "homo sapiens" : none,  // BIDS assumes humans where it is missing
                       human ? p.age : none, human ? p.sex : none, human ? p.handedness : none,
                       human ? p.haptic_experience : none, to_string(kind),
                       human && p.consent ? "yes" : none);
}

// "n/a" says nothing: --resume does not repeat what is known of a person.
bool agrees(const std::string& said, const std::vector<std::string_view>& there) {
    std::vector<std::string_view> fields;
    split_at('\t', said, fields);
    return std::equal(fields.begin(), fields.end(), there.begin(), there.end(),
                      [](auto ours, auto theirs) { return ours == kNotAvailable || ours == theirs; });
}

constexpr const char* kOldest = "89+";  // BIDS: a higher age could tell who the person is

}  // namespace

std::string age_text(const std::string& years) {
    if (years == kNotAvailable || years == kOldest) return years;
    const auto age = parse_whole<std::int64_t>(years);
    if (!age || *age < 1 || *age > 120) {
        throw Error(ExitCode::kUsage, "age {}: must be whole years, 1 to 120, or n/a", years);
    }
    return *age >= 89 ? kOldest : std::to_string(*age);
}

std::string add_participant(const Dataset& dataset, std::uint32_t participant, SubjectKind kind,
                            const PersonDescription& person) {
    const std::string ours = line_of(participant, kind, person);
    const TurnLock lock(dataset.description());
    TsvFile table(dataset.participants(), kPersonColumns);
    CsvReader reader(dataset.participants(), kPersonColumns, '\t');
    while (reader.next()) {
        if (parse_participant(reader.field(0).text) != participant) continue;
        std::vector<std::string_view> there;
        for (std::size_t i = 0; i < kPersonColumns.size(); ++i) there.push_back(reader.field(i).text);
        return agrees(ours, there) ? std::string() : fmt::format("{}", fmt::join(there, ", "));
    }
    table.append(ours);
    return {};
}

namespace {

PersonTable table_of_people(const Dataset& dataset) {
    return {dataset.participants(), {kPersonColumns.begin(), kPersonColumns.end()}};
}

std::string& field_in(PersonTable& table, std::uint32_t participant, std::string_view column) {
    const auto place = static_cast<std::size_t>(
        std::find(kPersonColumns.begin(), kPersonColumns.end(), column) - kPersonColumns.begin());
    if (PersonTable::Line* const line = table.find(participant)) return line->at(place);
    throw Error(ExitCode::kUsage, "{} is not in {}", participant_id(participant), table.file().string());
}

}  // namespace

std::string person_field(const Dataset& dataset, std::uint32_t participant, std::string_view column) {
    PersonTable table = table_of_people(dataset);
    return field_in(table, participant, column);
}

void set_person_field(const Dataset& dataset, std::uint32_t participant, std::string_view column,
                      const std::string& value) {
    const TurnLock lock(dataset.description());
    PersonTable table = table_of_people(dataset);
    field_in(table, participant, column) = value;
    table.write();
}

std::vector<std::uint32_t> read_participants(const Dataset& dataset) {
    std::vector<std::uint32_t> all;
    if (!is_table(dataset.participants())) return all;
    CsvReader reader(dataset.participants(), kPersonColumns, '\t');
    while (reader.next()) all.push_back(read_participant(reader.field(0)));
    return all;
}

}  // namespace thimble
