#include "session/participant/exclusions.hpp"

#include <array>

#include "common/error.hpp"
#include "session/participant/tsv.hpp"
#include "session/records/participant.hpp"

namespace thimble {
namespace {

constexpr std::array<std::string_view, 5> kExclusionColumns{"participant_id", "position", "record", "kind",
                                                            "reason"};

Exclusion read_exclusion(const CsvReader& reader) {
    Exclusion e;
    const auto participant = parse_participant(reader.field(0).text);
    if (!participant) reader.field(0).fail("is no participant, e.g. sub-07");
    e.participant = *participant;
    e.position = reader.field(1).whole();
    e.record = reader.field(2).whole();
    const std::string_view kind = reader.field(3).text;
    if (kind != "excluded" && kind != "rejected") reader.field(3).fail("is neither excluded nor rejected");
    e.kind = kind == "excluded" ? ExclusionKind::kExcluded : ExclusionKind::kRejected;
    e.reason = reader.field(4).text;
    return e;
}

}  // namespace

const char* to_string(ExclusionKind kind) {
    return kind == ExclusionKind::kExcluded ? "excluded" : "rejected";
}

void add_exclusion(const std::filesystem::path& file, const Exclusion& e) {
    const std::string reason = tsv_text(e.reason);
    if (reason == kNotAvailable) {
        throw Error(ExitCode::kUsage, "a trial is left out with a reason only: say why");
    }
    TsvFile(file, kExclusionColumns)
        .append({participant_id(e.participant), std::to_string(e.position), std::to_string(e.record),
                 to_string(e.kind), reason});
}

std::vector<Exclusion> read_exclusions(const std::filesystem::path& file) {
    std::vector<Exclusion> all;
    if (!is_table(file)) return all;
    CsvReader reader(file, kExclusionColumns, '\t');
    while (reader.next()) all.push_back(read_exclusion(reader));
    return all;
}

const Exclusion* find_exclusion(const std::vector<Exclusion>& all, std::uint32_t participant,
                                std::uint32_t record) {
    const Exclusion* found = nullptr;
    for (const Exclusion& e : all) {
        if (e.participant != participant || e.record != record) continue;
        if (found == nullptr || e.kind == ExclusionKind::kExcluded) found = &e;
    }
    return found;
}

}  // namespace thimble
