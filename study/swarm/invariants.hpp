// Rules that hold at every instant of every session, whatever fails. docs/safety.md has the same list with the same names.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/time.hpp"

namespace thimble {

enum class Rule : std::uint8_t {
    kForceLimit,
    kForceRate,
    kForceSent,
    kForceSilence,
    kForceAge,
    kForceModality,
    kGuardEnergy,
    kFingerLimit,
    kFingerSilence,
    kFingerModality,
    kBarSilence,
    kHeldNeedle,
    kStopRests,
    kStopHolds,
    kStopReaches,
    kRecordFinite,
    kTrialEnds,
    kRestAfter,
    kCountsAddUp,
    kNoCrash,
    kSameBits,
    kCount,
};

struct Invariant {
    std::string_view name, text;
};
inline constexpr std::array<Invariant, static_cast<std::size_t>(Rule::kCount)> kInvariants{{
    {"force-limit", "the force at the handle is a number, and not beyond [guard] force_limit_N"},
    {"force-rate", "the force at the handle grows no faster than [guard] force_rate_limit_N_per_s"},
    {"force-sent",
     "without a compensator, the force at the handle is at most one of the last that came, and what a codec "
     "predicts from it"},
    {"force-silence", "the handle's force ends in time when no force comes"},
    {"force-age", "the handle's force ends in time when all forces are too old"},
    {"force-modality", "the handle has a force in HF only"},
    {"guard-energy", "a handle that gave out more than [guard] energy_limit_J has no force"},
    {"finger-limit", "the force on a finger is a number, not negative, and within its limits"},
    {"finger-silence", "the finger's force ends in time when no force comes"},
    {"finger-modality", "fingers are pressed in CF and CCF only, or where a compensator says so"},
    {"bar-silence", "the bar is 0 in time when no force comes, and within its scale"},
    {"held-needle", "a needle without commands stands still, and its forces are zero"},
    {"stop-rests", "a node that knows of a stop runs no trial and gives no output"},
    {"stop-holds", "a stop holds until a release"},
    {"stop-reaches", "a stop reaches every program that runs"},
    {"record-finite",
     "the record has numbers, at times that increase; where bits flip on an unsealed path, at times that "
     "differ"},
    {"trial-ends", "a trial ends, and its record says why"},
    {"rest-after", "after a trial no output has a force"},
    {"counts-add-up", "netem's counters account for every datagram"},
    {"no-crash", "no program ends by an exception"},
    {"same-bits", "the same seed gives the same forces, scenes and samples, to the bit"},
}};
constexpr std::string_view name_of(Rule rule) { return kInvariants[static_cast<std::size_t>(rule)].name; }

struct Violation {
    Rule rule{};
    SessionTime at{};
    std::string text;
};

// The first violation stays.
class Verdict {
  public:
    void fail(Rule rule, SessionTime at, std::string text) {
        if (!first_) first_ = Violation{rule, at, std::move(text)};
    }
    const std::optional<Violation>& first() const { return first_; }

  private:
    std::optional<Violation> first_;
};

}  // namespace thimble
