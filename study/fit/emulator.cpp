#include "study/fit/emulator.hpp"

#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/math/portable.hpp"

namespace thimble {
namespace {

constexpr std::size_t kFeatures = kFeatureNames.size();
// Prior weight of slope zero, in pairs. In logarithms most relations are straight, so products of traits need many
// pairs.
constexpr double kLinearPrior = 0.1, kSquarePrior = 1000, kScalePrior = 20;
// Mean of log(z^2), z standard normal.
constexpr double kMeanLogSquare = -1.2703628454614782;
constexpr double kLeastScale = 1e-4;
constexpr double kLeastOwn = 1e-3;  // share of a feature that no other feature says

// Slopes of each feature on the rows' terms, with a prior weight per term.
std::vector<TrialFeatures> regress(const std::vector<std::vector<double>>& rows,
                                   const std::vector<TrialFeatures>& values, const std::vector<double>& prior,
                                   std::optional<Cholesky>& information) {
    const std::size_t terms = prior.size();
    std::vector<double> squares(terms * terms);
    std::vector<TrialFeatures> products(terms);
    for (std::size_t r = 0; r < rows.size(); ++r) {
        for (std::size_t i = 0; i < terms; ++i) {
            for (std::size_t j = 0; j <= i; ++j) squares[i * terms + j] += rows[r][i] * rows[r][j];
            for (std::size_t k = 0; k < kFeatures; ++k) products[i][k] += rows[r][i] * values[r][k];
        }
    }
    for (std::size_t i = 0; i < terms; ++i) squares[i * terms + i] += prior[i];
    information = Cholesky::of(std::move(squares), terms);
    if (!information)
        throw Error(ExitCode::kRunFailed, "all simulated trials are alike: raise --simulations");
    std::vector<double> column(terms);
    for (std::size_t k = 0; k < kFeatures; ++k) {
        for (std::size_t i = 0; i < terms; ++i) column[i] = products[i][k];
        information->solve(column);
        for (std::size_t i = 0; i < terms; ++i) products[i][k] = column[i];
    }
    return products;
}

TrialFeatures middle(const SimulatedPair& pair) {
    TrialFeatures mean{};
    for (std::size_t k = 0; k < kFeatures; ++k) mean[k] = 0.5 * (pair.first[k] + pair.second[k]);
    return mean;
}

void add_square(std::vector<double>& sums, const TrialFeatures& values) {
    for (std::size_t i = 0; i < kFeatures; ++i)
        for (std::size_t j = 0; j < kFeatures; ++j) sums[i * kFeatures + j] += values[i] * values[j];
}

// Of the variance of a mean, by the uncertainty of slopes that were learned from means of two.
double widening(double uncertainty, std::size_t trials) {
    return 1 + uncertainty * std::max(1.0, 0.5 * static_cast<double>(trials));
}

}  // namespace

void FeatureMean::add(const TrialFeatures& features) {
    ++trials;
    for (std::size_t k = 0; k < kFeatures; ++k)
        mean[k] += (features[k] - mean[k]) / static_cast<double>(trials);
}

Emulator::Emulator(std::span<const SimulatedPair> pairs, std::vector<std::size_t> acting)
    : acting_(std::move(acting)) {
    if (pairs.size() < kFewestPairs)
        throw Error(ExitCode::kRunFailed,
                    "only {} of the simulated people reached the beep twice in each condition, but a fit "
                    "needs {}: raise --simulations, or fit trials with less delay",
                    pairs.size(), kFewestPairs);
    fit_means(pairs);
    fit_scales(pairs);
    fit_covariances(pairs);
}

// 1, each acting trait, each product of two.
std::vector<double> Emulator::terms(const TraitScores& traits) const {
    const std::size_t n = acting_.size();
    std::vector<double> terms;
    terms.reserve(1 + n + n * (n + 1) / 2);
    terms.push_back(1);
    for (const std::size_t i : acting_) terms.push_back(traits[i]);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j <= i; ++j) terms.push_back(traits[acting_[i]] * traits[acting_[j]]);
    return terms;
}

void Emulator::fit_means(std::span<const SimulatedPair> pairs) {
    std::vector<std::vector<double>> rows;
    std::vector<TrialFeatures> values;
    rows.reserve(pairs.size());
    values.reserve(pairs.size());
    for (const SimulatedPair& pair : pairs) {
        rows.push_back(terms(pair.traits));
        values.push_back(middle(pair));
    }
    std::vector<double> prior(rows[0].size(), kSquarePrior);
    std::fill_n(prior.begin() + 1, acting_.size(), kLinearPrior);
    prior[0] = 0;
    slopes_ = regress(rows, values, prior, information_);
}

void Emulator::fit_scales(std::span<const SimulatedPair> pairs) {
    std::vector<std::vector<double>> rows;
    std::vector<TrialFeatures> values;
    rows.reserve(pairs.size());
    values.reserve(pairs.size());
    for (const SimulatedPair& pair : pairs) {
        std::vector<double> all = terms(pair.traits);
        const At here = at(pair.traits);
        const TrialFeatures features = middle(pair);
        TrialFeatures logs{};
        for (std::size_t k = 0; k < kFeatures; ++k) {
            const double rest = features[k] - here.mean[k];
            logs[k] =
                0.5 * (portable::log(std::max(rest * rest, kLeastScale * kLeastScale)) - kMeanLogSquare);
        }
        all.resize(1 + acting_.size());
        rows.push_back(std::move(all));
        values.push_back(logs);
    }
    std::vector<double> prior(rows[0].size(), kScalePrior);
    prior[0] = 0;
    std::optional<Cholesky> unused;
    scale_slopes_ = regress(rows, values, prior, unused);
}

void Emulator::fit_covariances(std::span<const SimulatedPair> pairs) {
    of_pairs_.assign(kFeatures * kFeatures, 0);
    within_.assign(kFeatures * kFeatures, 0);
    double spent = 0;  // by the slopes, in pairs
    for (const SimulatedPair& pair : pairs) {
        const At here = at(pair.traits);
        spent += here.uncertainty;
        TrialFeatures away = middle(pair), apart{};
        for (std::size_t k = 0; k < kFeatures; ++k) {
            away[k] = (away[k] - here.mean[k]) / here.scale[k];
            apart[k] = (pair.first[k] - pair.second[k]) / here.scale[k];
        }
        add_square(of_pairs_, away);
        add_square(within_, apart);
    }
    const auto n = static_cast<double>(pairs.size());
    for (double& sum : of_pairs_) sum /= std::max(n - spent, 1.0);
    for (double& sum : within_) sum /= 2 * n;
}

// A mean of n trials has within / n, and the regression's own error, which stays however many there are. That error is small, and its
// estimate uncertain: only its part in each feature counts.
Cholesky Emulator::covariance(std::size_t trials) const {
    std::vector<double> matrix = within_;
    for (double& value : matrix) value /= static_cast<double>(trials);
    for (std::size_t i = 0; i < matrix.size(); i += kFeatures + 1)
        matrix[i] += std::max(of_pairs_[i] - 0.5 * within_[i], 0.0) + kLeastOwn;
    auto factor = Cholesky::of(std::move(matrix), kFeatures);
    if (!factor) throw Error(ExitCode::kRunFailed, "all simulated trials are alike: raise --simulations");
    return *std::move(factor);
}

Emulator::At Emulator::at(const TraitScores& traits) const {
    std::vector<double> all = terms(traits);
    At here;
    for (std::size_t i = 0; i < all.size(); ++i)
        for (std::size_t k = 0; k < kFeatures; ++k) here.mean[k] += all[i] * slopes_[i][k];
    if (scale_slopes_.empty()) return here;
    for (std::size_t k = 0; k < kFeatures; ++k) {
        double log_scale = 0;
        for (std::size_t i = 0; i < scale_slopes_.size(); ++i) log_scale += all[i] * scale_slopes_[i][k];
        here.scale[k] = portable::exp(log_scale);
        here.log_scales += log_scale;
    }
    information_->solve_lower(all);
    here.uncertainty = std::inner_product(all.begin(), all.end(), all.begin(), 0.0);
    return here;
}

double Emulator::log_likelihood(const TraitScores& traits, const FeatureMean& mean,
                                const Cholesky& covariance) const {
    const At here = at(traits);
    const double wider = widening(here.uncertainty, mean.trials);
    TrialFeatures z{};
    for (std::size_t k = 0; k < kFeatures; ++k) z[k] = (mean.mean[k] - here.mean[k]) / here.scale[k];
    covariance.solve_lower(z);
    return -0.5 * std::inner_product(z.begin(), z.end(), z.begin(), 0.0) / wider - here.log_scales -
           0.5 * static_cast<double>(kFeatures) * portable::log(wider);
}

TrialFeatures Emulator::predict(const TraitScores& traits, const TrialFeatures& normals,
                                const Cholesky& covariance) const {
    const At here = at(traits);
    TrialFeatures z = normals;
    covariance.multiply_lower(z);
    const double wider = std::sqrt(widening(here.uncertainty, 1));
    for (std::size_t k = 0; k < kFeatures; ++k) z[k] = here.mean[k] + wider * here.scale[k] * z[k];
    return z;
}

}  // namespace thimble
