// The table of one participant's trials, sub-07_task-needle_beh.tsv: a line per trial that was begun and
// ended, in the order of time. Lines are only ever added.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "session/participant/tsv.hpp"
#include "session/records/trial_table.hpp"

namespace thimble {

struct DatasetRecord {
    std::uint32_t record = 1;    // from 1, of this participant
    std::uint32_t position = 1;  // in the order
    std::uint32_t block = 1;
    bool practice = false;
    std::uint32_t repeat_of = 0;  // the record that this one replaces; 0: none
    std::string repeat_reason;    // empty with 0
    std::uint32_t number = 0;     // on the wire; it keyed what a virtual operator drew
    TrialRow row;
};

class RecordTable {
  public:
    // New, or to be continued; half a line at the end goes. Throws Error as TsvFile.
    explicit RecordTable(const std::filesystem::path& file);
    // On the disk when it returns.
    void append(const DatasetRecord& record);

  private:
    TsvFile file_;
};

std::vector<std::string_view> record_columns();
// None if there is no file. Throws Error (data) naming line and column of what cannot be read.
std::vector<DatasetRecord> read_records(const std::filesystem::path& file);

// attention.tsv: an attention trial that was run, and whether the beep came within the limit.
struct AttentionResult {
    std::uint32_t participant = 0;
    std::uint32_t position = 0, record = 0;
    double beep_time_s = 0;  // since the start of the trial; NaN: no beep
    double limit_s = 0;
    bool passed = false;
};
AttentionResult judge_attention(std::uint32_t participant, const DatasetRecord& record, Duration limit);
void add_attention(const std::filesystem::path& file, const AttentionResult& result);
// Of all participants, the last one of a trial that was run again; none if there is no file.
// A program that will add lines takes kMayBeTorn: adding one cuts off what a crash has left.
std::vector<AttentionResult> read_attention(const std::filesystem::path& file,
                                            LastLine last = LastLine::kWhole);

// exclusions.tsv: trials that the experimenter rejected (run again) or excluded (left out for good), each
// with a reason. The trials' own lines stay as they are.
enum class ExclusionKind : std::uint8_t { kExcluded, kRejected, kIncluded };
const char* to_string(ExclusionKind kind);  // "excluded", "rejected", "included"

struct Exclusion {
    std::uint32_t participant = 0;
    std::uint32_t position = 0;  // in the participant's order
    std::uint32_t record = 0;    // the line of that trial that is meant (column "record")
    ExclusionKind kind = ExclusionKind::kExcluded;
    std::string reason;
};

// On the disk when it returns. Throws Error: usage, if the reason is empty; data, if the file is damaged.
void add_exclusion(const std::filesystem::path& file, Exclusion exclusion);
// Of all participants; none if there is no file. kMayBeTorn: as above.
std::vector<Exclusion> read_exclusions(const std::filesystem::path& file, LastLine last = LastLine::kWhole);
// The one of a record, null if there is none: an exclusion wins over a rejection. A later "included" takes back what stands before.
const Exclusion* find_exclusion(const std::vector<Exclusion>& all, std::uint32_t participant,
                                std::uint32_t record);

}  // namespace thimble
