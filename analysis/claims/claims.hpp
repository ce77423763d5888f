// The paper's claims, judged on a table of trials with the paper's tests, significance and direction. A claim is
// reproduced only if direction and significance both come out.
//
// Prattichizzo, Pacchierotti and Rosati, "Cutaneous Force Feedback as a Sensory Subtraction Technique in
// Haptics", IEEE Transactions on Haptics 5(4), 2012.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "analysis/text/html.hpp"
#include "session/records/trial_table.hpp"

namespace thimble {

// By-construction: the model contains the result. Recount: other claims say the same. Neither counts.
enum class ClaimKind : std::uint8_t { kResult, kSize, kByConstruction, kRecount };
inline constexpr std::array<std::string_view, 4> kClaimKindNames{"result", "size", "by-construction",
                                                                 "recount"};

struct Claim {
    std::string id;                       // "E1.mean.order"
    std::string claim;                    // in words
    std::string paper;                    // the paper's test and figure
    std::string ours = {};                // what came out here; why it could not be judged
    std::optional<bool> reproduced = {};  // nothing: not judged
    // Whether the direction alone comes out, whatever its significance; nothing where a claim has none
    // ("differs", "does not differ") or was not judged.
    std::optional<bool> direction = {};
    bool had_trials = false;  // false: its experiment was not run
    ClaimKind kind = ClaimKind::kResult;
    bool too_few = false;  // its trials are of fewer subjects than its test needs

    bool counts() const { return kind == ClaimKind::kResult || kind == ClaimKind::kSize; }
};

// With fewer subjects a P says little: only claims without a test are judged then.
inline constexpr std::size_t kFewestJudged = 6;

// Whether experiments, delays and modalities of the rows are the paper's. Other trials say nothing about its claims.
bool are_paper_trials(const std::vector<TrialRow>& rows);

// Every claim of the paper that can be checked, in a fixed order. Rows of any experiments, also of none.
// `no_lag`: trials of experiment 1 with CF again, the same but for actuators without lag (no_lag.csv).
std::vector<Claim> judge_claims(const std::vector<TrialRow>& rows, const std::vector<TrialRow>& no_lag = {});

// An object id, kind, claim, paper, ours, reproduced (null if not judged), direction (null if there is none), in
// this order.
nlohmann::ordered_json to_json(const Claim& claim);

// A list of such objects. Replaces the file; throws Error
// (run failed) if it cannot be written.
void write_claims(const std::vector<Claim>& claims, const std::filesystem::path& json);

// Table of the judged claims.
ReportTable claims_table(const std::vector<Claim>& claims);
// "17 of 19 judged results are reproduced", and the same of sizes, each with the claims that are not. Only claims that count.
std::string claims_sentence(const std::vector<Claim>& claims);

}  // namespace thimble
