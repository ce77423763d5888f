#include "analysis/statistics/cholesky.hpp"

#include <cmath>
#include <utility>

#include "common/math/portable.hpp"

namespace thimble {
namespace {

constexpr double kLeastPivot = 1e-12;  // of the diagonal

}  // namespace

std::optional<Cholesky> Cholesky::of(std::vector<double> matrix, std::size_t size) {
    for (std::size_t j = 0; j < size; ++j) {
        double* const row_j = &matrix[j * size];
        for (std::size_t i = j; i < size; ++i) {
            double* const row_i = &matrix[i * size];
            double sum = row_i[j];
            const double own = sum;
            for (std::size_t k = 0; k < j; ++k) sum -= row_i[k] * row_j[k];
            // A row that depends on others leaves rounding alone, about 1e-15 of its diagonal.
            if (i == j && !(sum > kLeastPivot * own)) return std::nullopt;
            row_i[j] = i == j ? std::sqrt(sum) : sum / row_j[j];
        }
    }
    return Cholesky(std::move(matrix), size);
}

void Cholesky::solve_lower(std::span<double> b) const {
    for (std::size_t i = 0; i < size_; ++i) {
        double sum = b[i];
        for (std::size_t k = 0; k < i; ++k) sum -= at(i, k) * b[k];
        b[i] = sum / at(i, i);
    }
}

void Cholesky::solve(std::span<double> b) const {
    solve_lower(b);
    for (std::size_t i = size_; i-- > 0;) {
        double sum = b[i];
        for (std::size_t k = i + 1; k < size_; ++k) sum -= at(k, i) * b[k];
        b[i] = sum / at(i, i);
    }
}

void Cholesky::multiply_lower(std::span<double> b) const {
    for (std::size_t i = size_; i-- > 0;) {
        double sum = 0;
        for (std::size_t k = 0; k <= i; ++k) sum += at(i, k) * b[k];
        b[i] = sum;
    }
}

double Cholesky::log_determinant() const {
    double sum = 0;
    for (std::size_t i = 0; i < size_; ++i) sum += 2 * portable::log(at(i, i));
    return sum;
}

}  // namespace thimble
