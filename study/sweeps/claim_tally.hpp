// How often each claim comes out, over studies that differ in seed or in parameters.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "analysis/claims/claims.hpp"
#include "analysis/statistics/named_values.hpp"
#include "analysis/text/html.hpp"

namespace thimble {

// A claim that comes out less often is called fragile.
inline constexpr double kFragileBelow = 0.8;
// One that comes out at least so often is called reproduced: the lower end of its 95 % Wilson interval counts, so that no luck with
// seeds does it. It takes 35 studies.
inline constexpr double kReproducedFrom = 0.9;

enum class ClaimClass : std::uint8_t {
    kNotJudged,   // its experiment was not run, or by too few subjects for its test
    kReproduced,  // at the paper's own significance in at least kReproducedFrom of the studies
    kDirection,   // less often, but its direction in at least kReproducedFrom of them
    kLess,        // neither; or a claim without a direction that comes out less often
};
const char* to_string(ClaimClass c);  // "not judged", "reproduced", "in direction", "less often"

struct ClaimCount {
    Claim claim;  // as judged in the first study
    std::uint32_t studies = 0;
    std::uint32_t judged = 0;
    bool judgeable = false;  // a study had trials of enough subjects for it
    std::uint32_t reproduced = 0;
    std::uint32_t directed = 0;  // studies in which it had a direction
    std::uint32_t direction = 0;

    // Of all studies: where a test refuses the data, the claim does not come out.
    double fraction() const { return studies > 0 ? static_cast<double>(reproduced) / studies : 0; }
    double direction_fraction() const { return directed > 0 ? static_cast<double>(direction) / studies : 0; }
    ConfidenceInterval interval() const;            // of fraction(), Wilson, 95 %; studies > 0
    ConfidenceInterval direction_interval() const;  // likewise
    bool fragile() const { return judgeable && fraction() < kFragileBelow; }
    ClaimClass classified() const;
};

class ClaimTally {
  public:
    // All claims of one study, every time in the same order.
    void add(const std::vector<Claim>& claims);
    const std::vector<ClaimCount>& counts() const { return counts_; }
    std::uint32_t studies() const { return studies_; }
    std::size_t fragile() const;

  private:
    std::vector<ClaimCount> counts_;
    std::uint32_t studies_ = 0;
};

// "E1.mean.order,1,0\n": id, reproduced, direction; each 1, 0, or nothing. How a line of every table of claims
// ends.
std::string claim_cells(const Claim& claim);

// `what`: "seeds", "draws". Fractions with their intervals, class, and what came out in the first study.
ReportTable tally_table(std::string title, const ClaimTally& tally, const std::string& what,
                        bool only_fragile);
// A claim's object (claims.hpp) with class, studies_judged, studies_reproduced, fraction, interval and
// direction_fraction; `reproduced` and `direction` say whether the class' limit is reached.
nlohmann::ordered_json to_json(const ClaimCount& count);
void write_tally(const ClaimTally& tally, const std::filesystem::path& json);

}  // namespace thimble
