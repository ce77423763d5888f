#include "analysis/claims/claims.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/claims/claim_findings.hpp"
#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

std::size_t fewest_subjects(const PaperClaim& of, const Experiments& experiments) {
    std::size_t fewest = kFewestJudged;
    for (const auto need : of.needs) fewest = std::min(fewest, (experiments.*need).subjects().size());
    return fewest;
}

constexpr double kPapersDelay_s = 0.05;

bool is_of_the_paper(const TrialConditions& c) {
    const bool delay =
        same_delay(c.delay_s, 0) || (c.experiment == 3 && same_delay(c.delay_s, kPapersDelay_s));
    return c.experiment >= 1 && c.experiment <= 3 && delay && c.removes_fixture == (c.experiment == 2) &&
           c.compensator == Compensator::kNone;
}

// For an experiment that has trials.
bool has_all_modalities(const std::vector<TrialRow>& rows, std::uint32_t experiment) {
    if (of_experiment(rows, experiment).empty()) return true;
    const StudyColumns columns(rows, experiment);
    const auto& conditions = columns.conditions();
    return std::none_of(conditions.begin(), conditions.end(),
                        [&](const auto& condition) { return columns.rows_of(condition).empty(); });
}

Claim judged(const PaperClaim& of, const Experiments& experiments) {
    Claim claim{of.id, of.claim, of.paper};
    claim.kind = of.kind;
    claim.had_trials = std::none_of(of.needs.begin(), of.needs.end(),
                                    [&](const auto need) { return (experiments.*need).empty(); });
    if (!claim.had_trials) {
        claim.ours = "not judged: there are no trials for it";
        return claim;
    }
    const std::size_t fewest = fewest_subjects(of, experiments);
    claim.too_few = of.has_test && fewest < kFewestJudged;
    if (claim.too_few) {
        claim.ours = fmt::format("not judged: {} subject{}, at least {} are needed", fewest,
                                 fewest == 1 ? "" : "s", kFewestJudged);
        return claim;
    }
    try {
        Finding finding = of.judge(experiments);
        claim.ours = std::move(finding.ours);
        claim.reproduced = finding.reproduced;
        claim.direction = finding.direction;
    } catch (const Error& refused) {
        claim.ours = fmt::format("not judged: {}", refused.what());
    }
    return claim;
}

}  // namespace

bool are_paper_trials(const std::vector<TrialRow>& rows) {
    return !rows.empty() &&
           std::all_of(rows.begin(), rows.end(),
                       [](const TrialRow& row) { return is_of_the_paper(row.conditions); }) &&
           has_all_modalities(rows, 1) && has_all_modalities(rows, 2) && has_all_modalities(rows, 3);
}

std::vector<Claim> judge_claims(const std::vector<TrialRow>& rows, const std::vector<TrialRow>& no_lag) {
    const Experiments experiments{{rows, 1}, {rows, 2}, {rows, 3}, {no_lag, 1}};
    std::vector<Claim> claims;
    for (const PaperClaim& claim : paper_claims()) claims.push_back(judged(claim, experiments));
    return claims;
}

nlohmann::ordered_json to_json(const Claim& claim) {
    nlohmann::ordered_json json{{"id", claim.id},
                                {"kind", kClaimKindNames[static_cast<std::size_t>(claim.kind)]},
                                {"claim", claim.claim},
                                {"paper", claim.paper},
                                {"ours", claim.ours}};
    json["reproduced"] = or_null(claim.reproduced);
    json["direction"] = or_null(claim.direction);
    return json;
}

void write_claims(const std::vector<Claim>& claims, const std::filesystem::path& json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Claim& claim : claims) list.push_back(to_json(claim));
    write_text_file(json, json_text(list, 2) + "\n");
}

ReportTable claims_table(const std::vector<Claim>& claims) {
    ReportTable table{"The paper's claims",
                      "Reproduced: direction and significance are those of the paper. A size is reproduced "
                      "if it is within the limit that follows from the paper. Claims that hold by "
                      "construction, and claims that repeat others, are not counted.",
                      {"id", "kind", "claim", "the paper", "here", "reproduced"}};
    for (const Claim& c : claims) {
        if (!c.reproduced) continue;
        table.rows.push_back({c.id, std::string(kClaimKindNames[static_cast<std::size_t>(c.kind)]), c.claim,
                              c.paper, c.ours,
                              *c.reproduced         ? "yes"
                              : c.direction == true ? "only the direction"
                                                    : "no"});
    }
    return table;
}

namespace {

// Of one kind: "17 of 19 judged results are reproduced; not: E1.normal". Nothing if none was judged.
std::string count_text(const std::vector<Claim>& claims, ClaimKind kind, const char* name) {
    unsigned judged = 0, reproduced = 0;
    std::string missing;
    for (const Claim& c : claims) {
        if (c.kind != kind || !c.reproduced) continue;
        ++judged;
        reproduced += *c.reproduced;
        if (!*c.reproduced) missing += (missing.empty() ? "; not reproduced: " : ", ") + c.id;
    }
    if (judged == 0) return "";
    return fmt::format("{} of {} judged {} {} reproduced{}", reproduced, judged, name,
                       reproduced == 1 ? "is" : "are", missing);
}

}  // namespace

std::string claims_sentence(const std::vector<Claim>& claims) {
    const std::string sizes = count_text(claims, ClaimKind::kSize, "sizes");
    std::string text = count_text(claims, ClaimKind::kResult, "results");
    if (text.empty())
        return fmt::format("No claim of the paper can be judged: at least {} subjects are needed",
                           kFewestJudged);
    if (!sizes.empty()) text += "; " + sizes;
    const auto refused = std::count_if(claims.begin(), claims.end(), [](const Claim& c) {
        return c.counts() && c.had_trials && !c.reproduced;
    });
    if (refused > 0) text += fmt::format("; {} more cannot be judged", refused);
    return text;
}

}  // namespace thimble
