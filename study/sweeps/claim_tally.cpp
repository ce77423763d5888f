#include "study/sweeps/claim_tally.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/statistics/descriptive.hpp"
#include "common/json_text.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

std::string fraction_text(const ClaimCount& c) {
    if (!c.judgeable) return "not judged";
    const ConfidenceInterval interval = c.interval();
    return fmt::format("{:.0f} % ({:.0f} to {:.0f})", 100 * c.fraction(), 100 * interval.low,
                       100 * interval.high);
}

}  // namespace

const char* to_string(ClaimClass c) {
    switch (c) {
        case ClaimClass::kNotJudged:
            return "not judged";
        case ClaimClass::kReproduced:
            return "reproduced";
        case ClaimClass::kDirection:
            return "in direction";
        case ClaimClass::kLess:
            return "less often";
    }
    return "?";
}

ConfidenceInterval ClaimCount::interval() const { return wilson_interval(reproduced, studies); }

ClaimClass ClaimCount::classified() const {
    if (!judgeable) return ClaimClass::kNotJudged;
    if (interval().low >= kReproducedFrom) return ClaimClass::kReproduced;
    return directed > 0 && direction_interval().low >= kReproducedFrom ? ClaimClass::kDirection
                                                                       : ClaimClass::kLess;
}

ConfidenceInterval ClaimCount::direction_interval() const { return wilson_interval(direction, studies); }

void ClaimTally::add(const std::vector<Claim>& claims) {
    if (counts_.empty()) {
        for (const Claim& claim : claims) {
            counts_.emplace_back();
            counts_.back().claim = claim;
        }
    }
    for (std::size_t i = 0; i < claims.size(); ++i) {
        ClaimCount& count = counts_[i];
        ++count.studies;
        count.judgeable = count.judgeable || (claims[i].had_trials && !claims[i].too_few);
        count.judged += claims[i].reproduced.has_value();
        count.reproduced += claims[i].reproduced.value_or(false);
        count.directed += claims[i].direction.has_value();
        count.direction += claims[i].direction.value_or(false);
    }
    ++studies_;
}

std::size_t ClaimTally::fragile() const {
    return static_cast<std::size_t>(
        std::count_if(counts_.begin(), counts_.end(), [](const ClaimCount& c) { return c.fragile(); }));
}

std::string claim_cells(const Claim& claim) {
    const auto flag = [](const std::optional<bool>& verdict) { return !verdict ? "" : *verdict ? "1" : "0"; };
    return fmt::format("{},{},{}\n", claim.id, flag(claim.reproduced), flag(claim.direction));
}

ReportTable tally_table(std::string title, const ClaimTally& tally, const std::string& what,
                        bool only_fragile) {
    ReportTable table{
        std::move(title),
        fmt::format("Reproduced: fraction of {0} in which direction and significance are those of the paper, "
                    "with its 95 % Wilson interval. Direction: fraction in which the direction is that of "
                    "the paper, whatever the significance. With the first: result with the first of the {0}.",
                    what),
        {"id", "claim", "the paper", what, "reproduced", "direction", "class", "with the first"}};
    for (const ClaimCount& c : tally.counts()) {
        if (only_fragile && !c.fragile()) continue;
        table.rows.push_back({c.claim.id, c.claim.claim, c.claim.paper, fmt::format("{}", c.studies),
                              fraction_text(c),
                              c.directed > 0 ? fmt::format("{:.0f} %", 100 * c.direction_fraction()) : "",
                              to_string(c.classified()), c.claim.ours});
    }
    return table;
}

nlohmann::ordered_json to_json(const ClaimCount& count) {
    Claim over_all = count.claim;
    over_all.reproduced = over_all.direction = std::nullopt;
    if (count.judgeable) over_all.reproduced = count.interval().low >= kReproducedFrom;
    if (count.directed > 0) over_all.direction = count.direction_interval().low >= kReproducedFrom;
    nlohmann::ordered_json entry = to_json(over_all);
    entry["class"] = to_string(count.classified());
    entry["studies"] = count.studies;
    entry["studies_judged"] = count.judged;
    entry["studies_reproduced"] = count.reproduced;
    if (count.judgeable) {
        entry["fraction"] = count.fraction();
        entry["interval"] = {count.interval().low, count.interval().high};
    }
    if (count.directed > 0) entry["direction_fraction"] = count.direction_fraction();
    return entry;
}

void write_tally(const ClaimTally& tally, const std::filesystem::path& json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const ClaimCount& c : tally.counts()) list.push_back(to_json(c));
    write_text_file(json, json_text(list, 2) + "\n");
}

}  // namespace thimble
