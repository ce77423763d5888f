// Which modalities a link is good for, and a link test in words and as JSON. Pure. The rules (docs/machines.md):
//
// HF. The loop hand - network - fixture - network - handle must be stable: round trip + half a sample below the critical
//   delay (critical_delay.hpp) of the session's own handle, nominal hand and fixture. The 99th percentile below it: fits;
//   only the median: marginal. A force that is later than [master] oldest_force_s and stale_after_s allow counts as none: the same.
// CF, CCF, VF. The delayed force never reaches the handle, so no delay makes the loop unstable (spec: "CF/CCF/VF"); it makes
//   the hand stop later, and the needle goes deeper by speed x delay. Without a network it already runs on for the
//   modality's own latency, display and reaction. A round trip up to half of that fits, up to all of it (twice as deep) is
//   marginal.
// All. A pause of the link longer than [slave_sim] stale_after_s holds the needle and starts the contact time anew: at best
//   marginal. A pause longer than [master] stale_after_s releases every display: does not fit. More than 5 % of the samples
//   lost is marginal, half of them does not fit.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/messages.hpp"
#include "study/loop_limits.hpp"
#include "thimble/link_test/link_figures.hpp"

namespace thimble {

enum class Fit : std::uint8_t { kFits, kMarginal, kDoesNotFit };
const char* to_string(Fit fit);

struct ModalityVerdict {
    Modality modality = Modality::kHF;
    Fit fit = Fit::kDoesNotFit;
    std::string reason;
};
// `link` was measured.
ModalityVerdict judge(Modality modality, const LoopFigures& link, const LoopLimits& limits);
// None if no port of the haptic loop answered.
std::vector<ModalityVerdict> judge_all(const std::vector<Modality>& modalities, const LinkFigures& link,
                                       const LoopLimits& limits);

struct LinkReport {
    LinkFigures link;
    std::vector<ModalityVerdict> verdicts;
    std::string chrony;  // a sentence
};

std::string to_text(const LinkReport& report);
nlohmann::ordered_json to_json(const LinkReport& report);

// 3 (network) if a port does not answer or the session's datagrams do not pass, 1 if a modality does not fit, else 0.
ExitCode exit_code(const LinkReport& report);

}  // namespace thimble
