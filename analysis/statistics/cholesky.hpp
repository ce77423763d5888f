// The triangular factor L of a symmetric positive definite matrix A = L L', for least squares and normal densities.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace thimble {

class Cholesky {
  public:
    // `matrix` is row-major, size x size; the part above its diagonal is not read. Nothing if it is not positive definite.
    static std::optional<Cholesky> of(std::vector<double> matrix, std::size_t size);

    std::size_t size() const { return size_; }
    // In place: L^-1 b and A^-1 b.
    void solve_lower(std::span<double> b) const;
    void solve(std::span<double> b) const;
    // In place: L b.
    void multiply_lower(std::span<double> b) const;
    double log_determinant() const;  // of A

  private:
    Cholesky(std::vector<double> lower, std::size_t size) : lower_(std::move(lower)), size_(size) {}
    double at(std::size_t row, std::size_t column) const { return lower_[row * size_ + column]; }

    std::vector<double> lower_;
    std::size_t size_;
};

}  // namespace thimble
