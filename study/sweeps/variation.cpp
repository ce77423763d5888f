#include "study/sweeps/variation.hpp"

#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/figures/heat_map.hpp"
#include "common/json_text.hpp"
#include "common/process/progress.hpp"
#include "common/text_file.hpp"

namespace thimble {

namespace {

ReportTable survival_table(const Variation& variation) {
    ReportTable table{variation.range.name(),
                      "Percent of seeds in which direction and significance are those of the paper.",
                      {"id"}};
    for (const VariedPoint& point : variation.points)
        table.columns.push_back(fmt::format("{:g}", point.value));
    for (const std::size_t i : shown_claims(variation)) {
        std::vector<std::string> row{variation.points.front().tally.counts()[i].claim.id};
        for (const VariedPoint& point : variation.points) {
            row.push_back(fmt::format("{:.0f}", 100 * point.tally.counts()[i].fraction()));
        }
        table.rows.push_back(std::move(row));
    }
    return table;
}

nlohmann::ordered_json to_json(const Variation& variation) {
    nlohmann::ordered_json points = nlohmann::ordered_json::array();
    for (const VariedPoint& point : variation.points) {
        nlohmann::ordered_json claims = nlohmann::ordered_json::array();
        for (const std::size_t i : shown_claims(variation)) {
            const ClaimCount& c = point.tally.counts()[i];
            claims.push_back({{"id", c.claim.id}, {"fraction", c.fraction()}, {"studies", c.studies}});
        }
        points.push_back({{"value", point.value}, {"claims", std::move(claims)}});
    }
    return {
        {"parameter", variation.range.name()}, {"keys", variation.range.keys}, {"points", std::move(points)}};
}

class Sweep {
  public:
    Sweep(const std::filesystem::path& config, const std::vector<ParameterRange>& ranges,
          const SweepOptions& options)
        : config_(config), ranges_(ranges), options_(options) {}

    VariationResult run() {
        for (const ParameterRange& range : ranges_) {
            for (unsigned i = 0; i < range.points; ++i) settings_of(range, range.at(i));
            all_ += std::size_t{range.points} * options_.seeds;
        }
        claim_folder(options_);
        ClaimsFile file("claims_vary.csv", "parameter,value,seed", options_);
        for (const ParameterRange& range : ranges_) {
            if (result_.complete) vary(range, file);
        }
        if (!result_.variations.empty()) write();
        return std::move(result_);
    }

  private:
    SystemSettings settings_of(const ParameterRange& range, double value) const {
        std::vector<SettingChange> changes;
        range.set(changes, value);
        return load_system_settings(config_, changes);
    }

    void vary(const ParameterRange& range, ClaimsFile& file) {
        Variation variation{range, {}};
        for (unsigned i = 0; i < range.points && result_.complete; ++i) {
            VariedPoint point{range.at(i), {}};
            judge(range, point, file);
            if (result_.complete) variation.points.push_back(std::move(point));
        }
        if (!variation.points.empty()) result_.variations.push_back(std::move(variation));
    }

    void judge(const ParameterRange& range, VariedPoint& point, ClaimsFile& file) {
        SystemSettings settings = settings_of(range, point.value);
        const auto take = [&](std::uint64_t seed, const std::vector<Claim>& claims) {
            file.append(fmt::format("{},{},{}", range.name(), point.value, seed), claims);
            progress_.count(++judged_, all_, "studies",
                            fmt::format("{} = {:g}, seed {}: {}", range.name(), point.value, seed,
                                        claims_sentence(claims)));
        };
        result_.complete = judge_studies(
            options_, [&settings](std::uint64_t) -> SystemSettings { return settings; }, point.tally, take);
    }

    void write() const {
        nlohmann::ordered_json list = nlohmann::ordered_json::array();
        for (const Variation& variation : result_.variations) list.push_back(to_json(variation));
        write_text_file(options_.out / "vary.json", json_text(list, 2) + "\n");
        std::vector<ReportSection> sections;
        for (const Variation& variation : result_.variations) sections.push_back(section(variation));
        write_sweep_report(options_, "Thimble: the paper's claims by parameter values", std::move(sections),
                           "seeds per point", options_.seeds, result_.complete);
    }

    ReportSection section(const Variation& variation) const {
        ReportSection section;
        section.title = fmt::format("{} from {:g} to {:g}", variation.range.name(),
                                    variation.points.front().value, variation.points.back().value);
        if (shown_claims(variation).empty()) {
            section.text = claims_sentence({}) + ".";
            return section;
        }
        section.drawn = draw_survival(variation, options_.out);
        section.tables = {survival_table(variation)};
        return section;
    }

    const std::filesystem::path& config_;
    const std::vector<ParameterRange>& ranges_;
    const SweepOptions& options_;
    Progress progress_;
    std::size_t judged_ = 0, all_ = 0;  // studies
    VariationResult result_;
};

}  // namespace

std::vector<std::size_t> shown_claims(const Variation& variation) {
    std::vector<std::size_t> indices;
    const auto& claims = variation.points.front().tally.counts();
    for (std::size_t i = 0; i < claims.size(); ++i) {
        if (claims[i].judgeable) indices.push_back(i);
    }
    return indices;
}

VariationResult run_variations(const std::filesystem::path& config, const std::vector<ParameterRange>& ranges,
                               const SweepOptions& options) {
    return Sweep(config, ranges, options).run();
}

DrawnFigures draw_survival(const Variation& variation, const std::filesystem::path& output) {
    const auto& claims = variation.points.front().tally.counts();
    const std::vector<std::size_t> indices = shown_claims(variation);
    HeatMap map{{},
                {},
                {},
                variation.range.name(),
                fmt::format("seeds (n = {})", variation.points.front().tally.studies()),
                "seeds in which the claim is reproduced",
                kSkyBlue};
    for (const std::size_t index : indices) map.rows.push_back(claims[index].claim.id);
    for (std::size_t x = 0; x < variation.points.size(); ++x) {
        const VariedPoint& point = variation.points[x];
        map.columns.push_back(fmt::format("{:g}", point.value));
        for (std::size_t y = 0; y < indices.size(); ++y) {
            const double percent = 100 * point.tally.counts()[indices[y]].fraction();
            map.cells.push_back({x, y, percent, fmt::format("{:.0f}", percent)});
        }
    }
    FigureSource figure = heat_map_figure(map, "survival_" + variation.range.name());
    figure.title = "Reproduced claims";
    figure.caption = fmt::format("Percent of seeds in which each claim is reproduced, by the value of {}.",
                                 variation.range.name());
    return draw_figures({figure}, output);
}

}  // namespace thimble
