#include "study/fit/traits.hpp"

#include <cmath>
#include <numeric>

#include "analysis/statistics/descriptive.hpp"
#include "common/math/portable.hpp"

namespace thimble {
namespace {

using P = OperatorParameters;

// Of the standard normal distribution: 90 % lie within.
constexpr double kNinety = 1.6448536269514722;

struct Trait {
    double (*of)(const Subject&);
    double (*median)(const P&);
    double (*spread)(const P&);
    int modality;  // in whose trials alone it acts; negative: in all
};

double one(const P& /*unused*/) { return 1; }
double reaction_modality(const P& p) { return p.spread.reaction_modality; }
double stiffness(const P& p) { return p.spread.stiffness; }
template <Modality M>
double modality_factor(const Subject& s) {
    return s.reaction_modality_factor[static_cast<std::size_t>(M)];
}

enum : std::size_t { kSpeed, kArm, kGrip, kCriterion, kSway, kPush, kReaction, kFirstModality };

constexpr std::array<Trait, kTraitCount> kTraits{{
    {[](const Subject& s) { return s.speed_insert_needle_m_per_s; },
     [](const P& p) { return p.behaviour.speed_insert_needle_m_per_s; },
     [](const P& p) { return p.spread.speed; }, -1},
    {[](const Subject& s) { return s.arm_stiffness_N_per_m; },
     [](const P& p) { return p.hand.arm_stiffness_N_per_m; }, stiffness, -1},
    {[](const Subject& s) { return s.grip_stiffness_N_per_m; },
     [](const P& p) { return p.hand.grip_stiffness_N_per_m; }, stiffness, -1},
    {[](const Subject& s) { return s.criterion_N; }, [](const P& p) { return p.perception.criterion_N; },
     [](const P& p) { return p.spread.criterion; }, -1},
    {[](const Subject& s) { return s.sway_m; }, [](const P& p) { return p.noise.sway_m; },
     [](const P& p) { return p.spread.sway; }, -1},
    {[](const Subject& s) { return s.push_m; }, [](const P& p) { return p.behaviour.push_m; },
     [](const P& p) { return p.spread.push; }, -1},
    {[](const Subject& s) { return s.reaction_factor; }, one, [](const P& p) { return p.spread.reaction; },
     -1},
    {modality_factor<Modality::kHF>, one, reaction_modality, static_cast<int>(Modality::kHF)},
    {modality_factor<Modality::kCF>, one, reaction_modality, static_cast<int>(Modality::kCF)},
    {modality_factor<Modality::kCCF>, one, reaction_modality, static_cast<int>(Modality::kCCF)},
    {modality_factor<Modality::kVF>, one, reaction_modality, static_cast<int>(Modality::kVF)},
}};

// The trait of a modality's reaction.
constexpr std::size_t trait_of(Modality modality) {
    std::size_t i = kFirstModality;
    while (kTraits[i].modality != static_cast<int>(modality)) ++i;
    return i;
}

}  // namespace

TraitScores trait_scores(const OperatorParameters& population, const Subject& subject) {
    TraitScores scores{};
    for (std::size_t i = 0; i < kTraitCount; ++i) {
        const Trait& trait = kTraits[i];
        const double spread = trait.spread(population), median = trait.median(population);
        if (spread > 0 && median > 0) scores[i] = portable::log(trait.of(subject) / median) / spread;
    }
    return scores;
}

std::vector<std::size_t> acting_traits(const OperatorParameters& population, Modality modality) {
    std::vector<std::size_t> acting;
    for (std::size_t i = 0; i < kTraitCount; ++i) {
        const Trait& trait = kTraits[i];
        const bool never = trait.spread(population) == 0 || trait.median(population) == 0 ||
                           (i == kPush && population.behaviour.recovery != Recovery::kPush);
        const bool here = trait.modality < 0 || trait.modality == static_cast<int>(modality);
        if (!never && here) acting.push_back(i);
    }
    return acting;
}

double FittedKey::value(const TraitScores& scores) const {
    return median * portable::exp(std::inner_product(scores.begin(), scores.end(), spread.begin(), 0.0));
}

double FittedKey::spread_of_logarithm() const {
    return std::sqrt(std::inner_product(spread.begin(), spread.end(), spread.begin(), 0.0));
}

std::vector<FittedKey> fitted_keys(const OperatorParameters& population) {
    std::vector<FittedKey> keys;
    const auto add = [&](const char* name, double median, std::initializer_list<std::size_t> traits) {
        FittedKey& key = keys.emplace_back(FittedKey{std::string("operator.") + name, median, {}});
        for (const std::size_t i : traits) key.spread[i] = kTraits[i].spread(population);
        if (key.spread_of_logarithm() == 0 || median == 0) keys.pop_back();
    };
    const auto trait = [&](const char* name, std::size_t i) {
        add(name, kTraits[i].median(population), {i});
    };
    trait("speed_insert_needle_m_per_s", kSpeed);
    trait("arm_stiffness_N_per_m", kArm);
    trait("grip_stiffness_N_per_m", kGrip);
    trait("criterion_N", kCriterion);
    trait("sway_m", kSway);
    trait("push_m", kPush);
    const ReactionParameters& r = population.reaction;
    add("reaction_handle_s", r.handle_s, {kReaction, trait_of(Modality::kHF)});
    add("reaction_cutaneous_s", r.cutaneous_s, {kReaction, trait_of(Modality::kCF)});
    // CCF's reaction is the sum of three, which a subject has slower or faster together.
    add("reaction_tactile_s", r.tactile_s, {kReaction, trait_of(Modality::kCCF)});
    add("reaction_crossing_s", r.crossing_s, {kReaction, trait_of(Modality::kCCF)});
    add("reaction_compatibility_s", r.compatibility_s, {kReaction, trait_of(Modality::kCCF)});
    add("reaction_visual_s", r.visual_s, {kReaction, trait_of(Modality::kVF)});
    add("reaction_auditory_s", r.auditory_s, {kReaction});
    return keys;
}

std::vector<SettingChange> without_spread() {
    std::vector<SettingChange> changes;
    const ConfigFile description = ConfigFile::description();
    read_operator_parameters(description.table("operator"));
    for (const KeyDeclaration& key : description.declarations())
        if (key.path.starts_with("operator.spread_")) changes.push_back({key.path, 0});
    return changes;
}

KeySummary summarise(const FittedKey& key, std::span<const TraitScores> draws) {
    NamedValues values{key.key, {}}, logarithms{key.key, {}};
    for (const TraitScores& scores : draws) {
        values.values.push_back(key.value(scores));
        logarithms.values.push_back(portable::log(values.values.back()));
    }
    const double spread = key.spread_of_logarithm();
    return {key.key,
            sample_quantile(values, 0.5),
            sample_quantile(values, 0.05),
            sample_quantile(values, 0.95),
            key.median * portable::exp(-kNinety * spread),
            key.median * portable::exp(kNinety * spread),
            1 - sample_sd(logarithms) / spread};
}

}  // namespace thimble
