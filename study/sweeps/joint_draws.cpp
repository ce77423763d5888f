#include "study/sweeps/joint_draws.hpp"

#include <fmt/format.h>

#include "analysis/report/report.hpp"
#include "common/process/progress.hpp"
#include "common/random.hpp"

namespace thimble {
namespace {

SystemSettings settings_of(const std::filesystem::path& config, const std::vector<ParameterRange>& ranges,
                           const JointDraw& draw) {
    std::vector<SettingChange> changes;
    for (std::size_t i = 0; i < ranges.size(); ++i) ranges[i].set(changes, draw.values[i]);
    return load_system_settings(config, changes);
}

ReportTable ranges_table(const std::vector<ParameterRange>& ranges) {
    ReportTable table{"Parameters drawn", "Uniform and independent. SI.", {"parameter", "from", "to"}, {}};
    for (const ParameterRange& range : ranges) {
        table.rows.push_back({fmt::format("{}", fmt::join(range.keys, " = ")), fmt::format("{:g}", range.low),
                              fmt::format("{:g}", range.high)});
    }
    return table;
}

void report(const std::vector<ParameterRange>& ranges, const SweepOptions& options,
            const TallyResult& result) {
    ReportInput report;
    report.title = fmt::format("Thimble: the paper's claims over {} joint draws of the parameters",
                               result.tally.studies());
    ReportSection section;
    section.title = fmt::format("{} of {} claims come out in fewer than {:.0f} % of draws",
                                result.tally.fragile(), result.tally.counts().size(), 100 * kFragileBelow);
    section.tables = {tally_table("All claims", result.tally, "draws", false), ranges_table(ranges)};
    report.sections.push_back(std::move(section));
    report.provenance = sweep_provenance(options, "draws", result.tally.studies(), result.complete);
    write_report(report, options.out / "report.html");
}

class DrawFiles {
  public:
    DrawFiles(const std::vector<ParameterRange>& ranges, const SweepOptions& options)
        : draws_(options.out / "draws.csv", options.if_exists),
          claims_(options.out / "claims_draws.csv", options.if_exists) {
        std::string header = "seed";
        for (const ParameterRange& range : ranges) header += "," + range.name();
        draws_.write(header + "\n");
        claims_.write("seed,id,reproduced,direction\n");
    }
    void append(const JointDraw& draw, const std::vector<Claim>& claims) {
        std::string line = std::to_string(draw.seed);
        for (const double value : draw.values) line += fmt::format(",{}", value);
        draws_.write(line + "\n");
        for (const Claim& c : claims) claims_.write(fmt::format("{},{}", draw.seed, claim_cells(c)));
        draws_.sync();
        claims_.sync();
    }

  private:
    CsvFile draws_, claims_;
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
    DrawFiles files(ranges, options);
    TallyResult result;
    Progress progress;
    for (std::uint32_t i = 0; i < options.seeds; ++i) {
        const JointDraw draw = draw_jointly(ranges, options.protocols[0].seed + i);
        const auto claims = judge_study(settings_of(config, ranges, draw), options, draw.seed);
        if (!claims) {
            result.complete = false;
            break;
        }
        result.tally.add(*claims);
        files.append(draw, *claims);
        progress.show(fmt::format("draw {} of {}; {}", i + 1, options.seeds, claims_sentence(*claims)), true);
    }
    if (result.tally.studies() == 0) return result;
    write_tally(result.tally, options.out / "claims.json");
    report(ranges, options, result);
    return result;
}

}  // namespace thimble
