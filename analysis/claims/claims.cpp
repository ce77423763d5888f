#include "analysis/claims/claims.hpp"

#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/claims/claim_list.hpp"
#include "analysis/statistics/descriptive.hpp"
#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/text_file.hpp"

namespace thimble {

std::vector<Claim> judge_claims(const std::vector<TrialRow>& rows, const std::vector<TrialRow>& no_lag) {
    const StudyColumns one(rows, 1);
    const StudyColumns two(rows, 2);
    const StudyColumns three(rows, 3);
    std::vector<Claim> claims;
    claim_without_delay(one, claims);
    claim_sudden_removal(two, claims);
    claim_with_delay(one, three, claims);
    claim_in_the_discussion(one, StudyColumns(no_lag, 1), claims);
    claim_session_length(one, two, three, claims);
    return claims;
}

nlohmann::ordered_json to_json(const Claim& claim) {
    const auto verdict = [](const std::optional<bool>& value) {
        return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
    };
    nlohmann::ordered_json json{
        {"id", claim.id}, {"claim", claim.claim}, {"paper", claim.paper}, {"ours", claim.ours}};
    json["reproduced"] = verdict(claim.reproduced);
    json["direction"] = verdict(claim.direction);
    return json;
}

void write_claims(const std::vector<Claim>& claims, const std::filesystem::path& json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Claim& claim : claims) list.push_back(to_json(claim));
    write_text_file(json, json_text(list, 2) + "\n");
}

void add_claim(std::vector<Claim>& claims, const StudyColumns& columns, Claim claim,
               const std::function<Finding()>& judge) {
    if (columns.empty()) {
        claim.ours = "no trials to judge it by";
    } else {
        claim.had_trials = true;
        try {
            Finding finding = judge();
            claim.ours = std::move(finding.ours);
            claim.reproduced = finding.reproduced;
            claim.direction = finding.direction;
        } catch (const Error& refused) {
            claim.ours = fmt::format("not judged: {}", refused.what());
        }
    }
    claims.push_back(std::move(claim));
}

std::string p_text(double p) { return p > 0 ? fmt::format("P = {:.2g}", p) : "P < 1e-300"; }

std::string means_text(const SampleTable& table, Metric metric) {
    std::string text;
    for (std::size_t i = 0; i < table.conditions(); ++i) {
        text += fmt::format("{}{} {:.{}f}", i > 0 ? ", " : "", table.name(i),
                            sample_mean(table.column(i)) * info(metric).shown_per_si, info(metric).decimals);
    }
    return fmt::format("{}: {}", info(metric).label, text);
}

ReportTable claims_table(const std::vector<Claim>& claims) {
    ReportTable table{"The paper's claims",
                      "Reproduced: direction and the paper's significance both come out.",
                      {"id", "claim", "the paper", "here", "reproduced"},
                      {}};
    for (const Claim& c : claims) {
        table.rows.push_back({c.id, c.claim, c.paper, c.ours,
                              !c.reproduced         ? "not judged"
                              : *c.reproduced       ? "yes"
                              : c.direction == true ? "no, but the direction"
                                                    : "no"});
    }
    return table;
}

std::string claims_sentence(const std::vector<Claim>& claims) {
    unsigned judged = 0;
    unsigned reproduced = 0;
    std::string missing;
    for (const Claim& c : claims) {
        if (!c.reproduced) continue;
        ++judged;
        if (*c.reproduced) {
            ++reproduced;
        } else {
            missing += (missing.empty() ? "; not: " : ", ") + c.id;
        }
    }
    return fmt::format("{} of {} judged claims are reproduced{}", reproduced, judged, missing);
}

}  // namespace thimble
