// The shape of a delay distribution as it was measured: standardised deviates in rising order, as iproute2's
// .dist files hold them (read by jitter_table_file.hpp).
#pragma once

#include <vector>

namespace thimble {

class JitterTable {
  public:
    // At least two, finite, sorted; mean 0 and standard deviation 1 if delay and spread are to be what was asked.
    explicit JitterTable(std::vector<double> deviates);

    // The deviate below which a share u of all lies, u in [0, 1]. Deviate i of n stands at (i + 1/2) / n; between
    // them straight lines, beyond the outermost their values.
    double quantile(double u) const;

    const std::vector<double>& deviates() const { return deviates_; }
    // Of quantile(u) with u uniform in [0, 1], exact.
    double mean() const;
    double standard_deviation() const;

  private:
    std::vector<double> deviates_;
};

}  // namespace thimble
