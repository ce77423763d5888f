// A participant's order: which trials, in which order, in which blocks. Written to the disk before the first
// trial and read back from then on, never drawn again: a participant session that goes on after a power cut, an update or
// a changed session file goes on in the order that the participant began with.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "session/records/trial_record.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {

struct OrderEntry {
    std::uint32_t position = 1;  // from 1, practice included
    std::uint32_t block = 1;     // 0: practice; between two blocks is a break
    bool practice = false;
    TrialConditions conditions;
};

// Practice trials are numbered from here on, within the experiment that they practise: the numbers of the
// others, and with them all that is drawn, do not depend on how much was practised.
inline constexpr std::uint32_t kFirstPracticeTrial = 1001;

// Attention trials, likewise: an attentive participant passes them. They are in the easiest modality and are not analysed.
inline constexpr std::uint32_t kFirstAttentionTrial = 2001;
inline bool is_attention(const OrderEntry& entry) { return entry.conditions.trial >= kFirstAttentionTrial; }

// The order that the settings give. Throws Error (usage) without [protocol], or if more participants come than planned.
std::vector<OrderEntry> plan_order(const SystemSettings& settings, std::uint32_t participant);

void write_order(const std::filesystem::path& file, const std::vector<OrderEntry>& order);
// Throws Error (data) naming line and column of what cannot be read.
std::vector<OrderEntry> read_order(const std::filesystem::path& file, std::uint32_t participant);

// The first thing in which two orders differ, in words; empty if they are equal.
// `blinded`: the position alone.
std::string difference(const std::vector<OrderEntry>& written, const std::vector<OrderEntry>& planned,
                       bool blinded = false);

}  // namespace thimble
