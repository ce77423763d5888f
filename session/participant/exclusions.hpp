// exclusions.tsv: trials that the experimenter rejected (run again) or excluded (left out for good), each
// with a reason. The trials' own lines stay as they are.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace thimble {

enum class ExclusionKind : std::uint8_t { kExcluded, kRejected };
const char* to_string(ExclusionKind kind);  // "excluded", "rejected"

struct Exclusion {
    std::uint32_t participant = 0;
    std::uint32_t position = 0;  // in the participant's order
    std::uint32_t record = 0;    // the line of that trial that is meant (column "record")
    ExclusionKind kind = ExclusionKind::kExcluded;
    std::string reason;
};

// On the disk when it returns. Throws Error: usage, if the reason is empty; data, if the file is damaged.
void add_exclusion(const std::filesystem::path& file, const Exclusion& exclusion);
// Of all participants; none if there is no file.
std::vector<Exclusion> read_exclusions(const std::filesystem::path& file);
// The one of a record, null if there is none: an exclusion wins over a rejection.
const Exclusion* find_exclusion(const std::vector<Exclusion>& all, std::uint32_t participant,
                                std::uint32_t record);

}  // namespace thimble
