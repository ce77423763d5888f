// Short participant sessions for tests: settings, records and an agenda made by hand.
#pragma once

#include <string>

#include "session/participant/agenda.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {

// Two modalities, two trials each, one practice trial, breaks after every second trial.
inline SystemSettings short_settings(const std::string& more = "") {
    return read_system_settings(ConfigFile::parse(
        "[session]\nmodalities = ['HF', 'CF']\n[protocol]\nexperiments = [1]\nsubjects = 4\n"
        "trials_per_modality = 2\npractice_trials = 1\nbreak_every = 2\n" +
            more,
        "session.toml"));
}

inline DatasetRecord record_of(const OrderEntry& entry, std::uint32_t number,
                               EndReason reason = EndReason::kCompleted, std::uint32_t repeat_of = 0) {
    DatasetRecord record;
    record.record = number;
    record.position = entry.position;
    record.block = entry.block;
    record.practice = entry.practice;
    record.repeat_of = repeat_of;
    record.repeat_reason = repeat_of == 0 ? "" : "because";
    record.number = number;
    record.row.conditions = entry.conditions;
    record.row.reason = reason;
    if (reason == EndReason::kPeerLost) record.row.lost_peer = Role::kVisual;
    return record;
}

}  // namespace thimble
