// Tables [protocol] and [dataset] of a session file: the design of a study, whose participant sessions `thimble run` runs one by one,
// and the data's names. Without [protocol] `thimble run` runs one trial per modality and delay.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "common/config.hpp"

namespace thimble {

inline constexpr Duration kDelayOfExperiment3 = std::chrono::milliseconds{50};

enum class RepeatWhen : std::uint8_t { kEndOfBlock, kAtOnce };

struct ProtocolSettings {
    std::vector<std::uint32_t> experiments{3};  // [1], [2], [1, 2] or [3]: those without delay, or that with
    std::uint32_t subjects = 10;                // planned: participants P01 to P<subjects>
    std::uint32_t trials_per_modality = 6;
    std::uint32_t removals = 2;  // of the fixture, per participant; experiment 2
    std::uint32_t practice_trials = 4;
    std::uint32_t break_every = 12;
    std::string break_text;
    Duration break_minimum = std::chrono::seconds{30};
    RepeatWhen repeat = RepeatWhen::kEndOfBlock;
    std::uint32_t repeats_limit = 2;
    bool repeat_timeouts = true;
    std::uint32_t attention_every = 0;                    // trials between two attention trials; 0: none
    Duration attention_limit = std::chrono::seconds{30};  // an attentive subject has the beep by then
    bool blinded = false;          // the experimenter does not read modality, delay and results
    bool subject_goes_on = false;  // next_by = "subject": a person may begin the next trial
};

struct DatasetSettings {
    std::string name = "Needle insertion by touch";
    std::string license;  // e.g. "CC0"; empty: left out
    std::vector<std::string> authors, ethics_approvals;
};

// Throw Error (usage).
ProtocolSettings read_protocol_settings(const ConfigTable& table);
DatasetSettings read_dataset_settings(const ConfigTable& table);

}  // namespace thimble
