#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/process/progress.hpp"
#include "common/random.hpp"
#include "study/sweeps/variation.hpp"

namespace thimble {
namespace {

SystemSettings settings_of(const std::filesystem::path& config, const std::vector<ParameterRange>& ranges,
                           const JointDraw& draw) {
    std::vector<SettingChange> changes;
    for (std::size_t i = 0; i < ranges.size(); ++i) ranges[i].set(changes, draw.values[i]);
    return load_system_settings(config, changes);
}

ReportTable ranges_table(const std::vector<ParameterRange>& ranges) {
    ReportTable table{"Parameters drawn",
                      "Each draw is uniform between from and to, and independent of the others. SI units.",
                      {"parameter", "from", "to"}};
    for (const ParameterRange& range : ranges) {
        table.rows.push_back({fmt::format("{}", fmt::join(range.keys, " = ")), fmt::format("{:g}", range.low),
                              fmt::format("{:g}", range.high)});
    }
    return table;
}

class DrawsFile {
  public:
    DrawsFile(const std::vector<ParameterRange>& ranges, const SweepOptions& options)
        : file_(options.out / "draws.csv", options.if_exists) {
        std::string header = "seed";
        for (const ParameterRange& range : ranges) header += "," + range.name();
        file_.write(header + "\n");
    }
    void append(const JointDraw& draw) {
        file_.write(fmt::format("{},{}\n", draw.seed, fmt::join(draw.values, ",")));
        file_.sync();
    }

  private:
    CsvFile file_;
};

}  // namespace

JointDraw draw_jointly(const std::vector<ParameterRange>& ranges, std::uint64_t seed) {
    JointDraw draw{seed, {}};
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        RandomStream random({seed, 0, 0, static_cast<std::uint32_t>(i), Purpose::kParameter});
        draw.values.push_back(ranges[i].within(random.uniform()));
    }
    return draw;
}

TallyResult run_draws(const std::filesystem::path& config, const std::vector<ParameterRange>& ranges,
                      const SweepOptions& options) {
    // Both ends of every range must be readable before anything is written.
    for (const double share : {0.0, 1.0}) {
        JointDraw end;
        for (const ParameterRange& range : ranges) end.values.push_back(range.within(share));
        settings_of(config, ranges, end);
    }
    claim_folder(options);
    DrawsFile draws(ranges, options);
    ClaimsFile file("claims_draws.csv", "seed", options);
    Progress progress;
    TallyResult result;
    const ClaimTally& tally = result.tally;
    const auto take = [&](std::uint64_t seed, const std::vector<Claim>& claims) {
        draws.append(draw_jointly(ranges, seed));
        file.append(std::to_string(seed), claims);
        progress.count(tally.studies(), options.seeds, "draws", claims_sentence(claims));
    };
    result.complete = judge_studies(
        options, [&](std::uint64_t seed) { return settings_of(config, ranges, draw_jointly(ranges, seed)); },
        result.tally, take);
    if (tally.studies() == 0) return result;
    write_tally(tally, options.out / "claims.json");
    ReportSection section;
    section.title = fmt::format("{} of {} claims are reproduced in fewer than {:.0f} % of draws",
                                tally.fragile(), tally.counts().size(), 100 * kFragileBelow);
    section.tables = {tally_table("All claims", tally, "draws", false), ranges_table(ranges)};
    write_sweep_report(
        options,
        fmt::format("Thimble: the paper's claims over {} joint draws of the parameters", tally.studies()),
        {section}, "draws", tally.studies(), result.complete);
    return result;
}

}  // namespace thimble
