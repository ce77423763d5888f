// Which trials of a dataset an analysis may use, and why it may not use the others.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "session/participant/corrections.hpp"
#include "session/participant/dataset.hpp"
#include "session/participant/order_file.hpp"
#include "session/participant/record_table.hpp"
#include "session/records/trial_table.hpp"

namespace thimble {

enum class LeftOut : std::uint8_t { kPractice, kAttention, kExcluded, kRejected, kSuperseded, kFailed };
inline const char* to_string(LeftOut why) {
    constexpr std::array kNames{"practice", "attention trials",     "excluded",
                                "rejected", "replaced by a repeat", "failed"};
    return kNames.at(static_cast<std::size_t>(why));
}

struct LeftOutTrial {
    LeftOut why = LeftOut::kFailed;
    std::uint32_t participant = 0, position = 0, record = 0;
    std::string reason;  // the experimenter's, or the outcome
};

struct CountedTrials {
    std::vector<TrialRow> rows;  // one per trial of an order at most
    std::vector<LeftOutTrial> left_out;
    std::vector<AttentionResult> attention;  // without those of excluded and rejected trials
    std::size_t participants = 0, records = 0, corrections = 0;
    std::size_t missing = 0;  // trials of the orders without a row that counts, practice aside
};

inline std::optional<LeftOutTrial> judge(const DatasetRecord& record, const std::vector<DatasetRecord>& all,
                                         const std::vector<Exclusion>& exclusions,
                                         std::uint32_t participant) {
    const auto left_out = [&](LeftOut why, std::string reason) {
        return LeftOutTrial{why, participant, record.position, record.record, std::move(reason)};
    };
    if (record.practice) return left_out(LeftOut::kPractice, "");
    if (const Exclusion* mark = find_exclusion(exclusions, participant, record.record)) {
        const bool excluded = mark->kind == ExclusionKind::kExcluded;
        return left_out(excluded ? LeftOut::kExcluded : LeftOut::kRejected, mark->reason);
    }
    if (record.row.conditions.trial >= kFirstAttentionTrial) return left_out(LeftOut::kAttention, "");
    const auto repeat = std::find_if(
        all.begin(), all.end(), [&](const DatasetRecord& other) { return other.repeat_of == record.record; });
    if (repeat != all.end()) return left_out(LeftOut::kSuperseded, repeat->repeat_reason);
    if (ran_to_its_end(record.row)) return std::nullopt;
    return left_out(LeftOut::kFailed, outcome_text(record.row.reason, record.row.lost_peer));
}

// A record counts unless it is practice, an attention trial, excluded, rejected, superseded by a repeat, or
// failed (did not run to its end). Throws Error (data) if a file cannot be read.
inline CountedTrials counted_trials(const Dataset& dataset) {
    CountedTrials trials;
    trials.attention = read_attention(dataset.attention());
    trials.corrections = count_corrections(dataset.corrections());
    const std::vector<Exclusion> exclusions = read_exclusions(dataset.exclusions());
    std::erase_if(trials.attention, [&](const AttentionResult& result) {
        return find_exclusion(exclusions, result.participant, result.record) != nullptr;
    });
    for (const std::uint32_t participant : read_participants(dataset)) {
        const std::vector<DatasetRecord> records = read_records(dataset.records(participant));
        // A crash came before the first trial: there is nothing to count.
        if (records.empty() && !is_table(dataset.order(participant))) continue;
        ++trials.participants;
        trials.records += records.size();
        const std::size_t before = trials.rows.size();
        for (const DatasetRecord& record : records) {
            if (auto left_out = judge(record, records, exclusions, participant)) {
                trials.left_out.push_back(std::move(*left_out));
            } else {
                trials.rows.push_back(record.row);
            }
        }
        std::size_t planned = 0;
        for (const OrderEntry& entry : read_order(dataset.order(participant), participant)) {
            planned += entry.practice || is_attention(entry) ? 0 : 1;
        }
        trials.missing += planned - std::min(planned, trials.rows.size() - before);
    }
    return trials;
}

// How many each participant passed, and which ones not.
inline std::vector<std::string> describe_attention(const std::vector<AttentionResult>& all) {
    std::vector<std::string> lines;
    std::map<std::uint32_t, std::vector<const AttentionResult*>> of;
    for (const AttentionResult& result : all) of[result.participant].push_back(&result);
    lines.reserve(of.size());
    for (const auto& [participant, results] : of) {
        std::vector<std::uint32_t> failed;
        for (const AttentionResult* result : results)
            if (!result->passed) failed.push_back(result->position);
        lines.push_back(fmt::format("attention: {} passed {} of {} trials{}", participant_id(participant),
                                    results.size() - failed.size(), results.size(),
                                    failed.empty() ? "" : fmt::format(", not {}", fmt::join(failed, ", "))));
    }
    return lines;
}

// In words, a line each.
inline std::vector<std::string> describe(const CountedTrials& trials) {
    std::vector<std::string> lines{fmt::format("{} of {} records of {} participant{} count",
                                               trials.rows.size(), trials.records, trials.participants,
                                               trials.participants == 1 ? "" : "s")};
    for (const LeftOut why : {LeftOut::kPractice, LeftOut::kAttention, LeftOut::kExcluded, LeftOut::kRejected,
                              LeftOut::kSuperseded, LeftOut::kFailed}) {
        const auto n = std::count_if(trials.left_out.begin(), trials.left_out.end(),
                                     [&](const LeftOutTrial& trial) { return trial.why == why; });
        if (n > 0) lines.push_back(fmt::format("left out: {} {}", n, to_string(why)));
        if (why == LeftOut::kPractice || why == LeftOut::kAttention) continue;
        for (const LeftOutTrial& trial : trials.left_out) {
            if (trial.why != why) continue;
            lines.push_back(fmt::format("  {} trial {} (record {}): {}", participant_id(trial.participant),
                                        trial.position, trial.record, trial.reason));
        }
    }
    const auto attention = describe_attention(trials.attention);
    lines.insert(lines.end(), attention.begin(), attention.end());
    if (trials.corrections > 0)
        lines.push_back(
            fmt::format("corrected after the sessions: {} times (corrections.tsv)", trials.corrections));
    if (trials.missing > 0) {
        lines.push_back(fmt::format("planned trials without a valid record: {}", trials.missing));
    }
    return lines;
}

}  // namespace thimble
