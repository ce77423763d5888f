// Experiment 3: 50 ms on the force path.
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "analysis/claims/claim_list.hpp"
#include "analysis/claims/headline.hpp"
#include "analysis/statistics/friedman.hpp"

namespace thimble {
namespace {

// A subject without a value in a modality (HF never reached the beep) has no row.
std::string left_out_text(const StudyColumns& columns, const CompleteRows& complete) {
    if (complete.dropped.empty()) return "";
    return fmt::format("{} of {} subjects; ", complete.table.subjects(), columns.subjects().size());
}

Finding friedman_finding(const StudyColumns& columns, Metric metric) {
    const CompleteRows complete = columns.table(metric);
    const SampleTable& table = complete.table;
    const Friedman test = friedman(table);
    std::string ranks;
    for (std::size_t i = 0; i < table.conditions(); ++i) {
        ranks += fmt::format("{}{} {:.1f}", i > 0 ? ", " : "", table.name(i), test.mean_ranks[i]);
    }
    return {fmt::format("{}{}; mean ranks {}; chi^2 = {:.2f}, {} (asymptotic {})",
                        left_out_text(columns, complete), means_text(table, metric), ranks, test.chi_squared,
                        test.p_exact ? "exact " + p_text(*test.p_exact) : "no exact P",
                        p_text(test.p_asymptotic)),
            test.p() < kHighlySignificant};
}

// The first is larger than the second, at the paper's level.
Finding dunn_finding(const StudyColumns& columns, Metric metric, std::string_view larger,
                     std::string_view smaller, double level) {
    const SampleTable table = columns.table(metric).table;
    for (const DunnPair& pair : dunn_after_friedman(table)) {
        const bool forwards = table.name(pair.first) == larger && table.name(pair.second) == smaller;
        const bool backwards = table.name(pair.first) == smaller && table.name(pair.second) == larger;
        if (!forwards && !backwards) continue;
        const double difference = forwards ? pair.mean_rank_difference : -pair.mean_rank_difference;
        const bool is_larger = difference > 0;
        return {fmt::format("mean rank difference {:.2f}, {}", difference, p_text(pair.p_adjusted)),
                is_larger && pair.p_adjusted < level, is_larger};
    }
    return {"no such pair", false};
}

Finding stability_finding(const StudyColumns& columns) {
    std::string text;
    bool only_handle = true;
    for (const Modality modality : kModalities) {
        const OscillationCount count = count_oscillations(columns.rows(), modality);
        only_handle = only_handle && count.trials > 0 &&
                      oscillates_as_claimed(modality, true, count.trials, count.oscillating);
        text += fmt::format("{}{} {} of {}", text.empty() ? "trials that oscillate: " : ", ",
                            to_string(modality), count.oscillating, count.trials);
    }
    return {text, only_handle};
}

struct DunnClaim {
    const char* id;
    const char* claim;
    const char* paper;
    Metric metric;
    const char* larger;
    const char* smaller;
    double level;
};

constexpr std::array<DunnClaim, 6> kDunn{{
    {"E3.max.hf_cf", "maximum penetration HF > CF", "Dunn, P < .001", Metric::kPenetrationMax, "HF", "CF",
     1e-3},
    {"E3.max.hf_ccf", "maximum penetration HF > CCF", "Dunn, P < .05", Metric::kPenetrationMax, "HF", "CCF",
     0.05},
    {"E3.max.vf_cf", "maximum penetration VF > CF", "Dunn, P < .001", Metric::kPenetrationMax, "VF", "CF",
     1e-3},
    {"E3.time.hf_vf", "completion time HF > VF", "Dunn, P < .01", Metric::kCompletionTime, "HF", "VF", 0.01},
    {"E3.time.hf_cf", "completion time HF > CF", "Dunn, P < .05", Metric::kCompletionTime, "HF", "CF", 0.05},
    {"E3.time.hf_ccf", "completion time HF > CCF", "Dunn, P < .001", Metric::kCompletionTime, "HF", "CCF",
     1e-3},
}};

void add_dunn(const StudyColumns& three, Metric metric, std::vector<Claim>& claims) {
    for (const DunnClaim& c : kDunn) {
        if (c.metric != metric) continue;
        add_claim(claims, three, {c.id, c.claim, c.paper, "", {}, {}},
                  [&] { return dunn_finding(three, c.metric, c.larger, c.smaller, c.level); });
    }
}

}  // namespace

void claim_with_delay(const StudyColumns& one, const StudyColumns& three, std::vector<Claim>& claims) {
    add_claim(claims, three,
              {"E3.stable",
               "at 50 ms only HF oscillates; VF, CF and CCF hold a stable contact",
               "figure",
               "",
               {},
               {}},
              [&] { return stability_finding(three); });
    add_claim(claims, three,
              {"E3.max.differs", "maximum penetration differs", "Friedman, P < .0001", "", {}, {}},
              [&] { return friedman_finding(three, Metric::kPenetrationMax); });
    add_dunn(three, Metric::kPenetrationMax, claims);
    add_claim(claims, three,
              {"E3.time.differs", "completion time differs", "Friedman, P < .0001", "", {}, {}},
              [&] { return friedman_finding(three, Metric::kCompletionTime); });
    add_dunn(three, Metric::kCompletionTime, claims);
    add_claim(claims, one.empty() ? one : three,
              {"E3.time.only_delay",
               "HF's penalty in time is absent without delay",
               "E1.time.same with E3.time.differs",
               "",
               {},
               {}},
              [&] {
                  const double without = friedman(one.table(Metric::kCompletionTime).table).p();
                  const double with = friedman(three.table(Metric::kCompletionTime).table).p();
                  return Finding{
                      fmt::format("time: {} without delay, {} with", p_text(without), p_text(with)),
                      without > kNoDifference && with < kHighlySignificant};
              });
}

}  // namespace thimble
