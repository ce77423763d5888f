#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "common/math/portable.hpp"
#include "common/random.hpp"
#include "study/fit/operator_model.hpp"

namespace thimble {
namespace {

constexpr std::uint32_t kChain = 1;  // the stream's experiment; joint draws have 0
constexpr std::size_t kRounds = 4, kStepsOfRound = 600, kThinning = 3;
// The normal distribution is wider than the draws: its tails must not be thinner than the posterior's.
constexpr double kWider = 1.5, kFloor = 0.01;

// A normal distribution about which the chain moves; at first the population.
struct Base {
    TraitScores mean{};
    std::optional<Cholesky> factor;

    TraitScores draw(RandomStream& random) const {
        TraitScores z{};
        for (double& value : z) value = random.normal();
        if (factor) factor->multiply_lower(z);
        return z;
    }
    double log_density(const TraitScores& z) const {
        TraitScores away{};
        for (std::size_t i = 0; i < away.size(); ++i) away[i] = z[i] - mean[i];
        if (factor) factor->solve_lower(away);
        return -0.5 * std::inner_product(away.begin(), away.end(), away.begin(), 0.0);
    }
};

Base base_of(const std::vector<TraitScores>& draws) {
    const auto n = static_cast<double>(draws.size());
    Base base;
    for (const TraitScores& z : draws)
        for (std::size_t i = 0; i < kTraitCount; ++i) base.mean[i] += z[i] / n;
    std::vector<double> matrix(kTraitCount * kTraitCount);
    for (const TraitScores& z : draws)
        for (std::size_t i = 0; i < kTraitCount; ++i)
            for (std::size_t j = 0; j < kTraitCount; ++j)
                matrix[i * kTraitCount + j] += kWider * (z[i] - base.mean[i]) * (z[j] - base.mean[j]) / n;
    for (std::size_t i = 0; i < kTraitCount; ++i) matrix[i * kTraitCount + i] += kFloor;
    base.factor = Cholesky::of(std::move(matrix), kTraitCount);
    return base;
}

class Chain {
  public:
    Chain(const std::function<double(const TraitScores&)>& log_likelihood, std::uint64_t seed)
        : log_likelihood_(log_likelihood), random_({seed, kChain, 0, 0, Purpose::kParameter}) {}

    void move_about(Base base) {
        base_ = std::move(base);
        level_ = rest(here_);
    }

    const TraitScores& step() {
        const TraitScores other = base_.draw(random_), start = here_;
        const double threshold = level_ + portable::log(1 - random_.uniform());
        double angle = random_.uniform(0, 2 * std::numbers::pi), low = angle - 2 * std::numbers::pi,
               high = angle;
        for (;;) {
            const double keep = portable::cos(angle), take = portable::sin(angle);
            for (std::size_t i = 0; i < kTraitCount; ++i)
                here_[i] = base_.mean[i] + keep * (start[i] - base_.mean[i]) + take * other[i];
            level_ = rest(here_);
            // The angle 0 is the start itself, which has the level.
            if (level_ >= threshold || high - low < 1e-12) return here_;
            (angle < 0 ? low : high) = angle;
            angle = random_.uniform(low, high);
        }
    }

  private:
    // Of the posterior's logarithm what the base does not have.
    double rest(const TraitScores& z) const {
        return log_likelihood_(z) - 0.5 * std::inner_product(z.begin(), z.end(), z.begin(), 0.0) -
               base_.log_density(z);
    }

    const std::function<double(const TraitScores&)>& log_likelihood_;
    RandomStream random_;
    Base base_;
    TraitScores here_{};
    double level_ = 0;
};

}  // namespace

std::vector<TraitScores> slice_samples(const std::function<double(const TraitScores&)>& log_likelihood,
                                       std::uint64_t seed, std::size_t draws) {
    Chain chain(log_likelihood, seed);
    chain.move_about({});
    std::vector<TraitScores> kept;
    for (std::size_t round = 0; round < kRounds; ++round) {
        kept.clear();
        // The first half is burn-in.
        for (std::size_t i = 0; i < kStepsOfRound; ++i) {
            const TraitScores& z = chain.step();
            if (2 * i >= kStepsOfRound) kept.push_back(z);
        }
        chain.move_about(base_of(kept));
    }
    kept.clear();
    kept.reserve(draws);
    for (std::size_t i = 0; kept.size() < draws; ++i) {
        const TraitScores& z = chain.step();
        if (i % kThinning == 0) kept.push_back(z);
    }
    return kept;
}

}  // namespace thimble
