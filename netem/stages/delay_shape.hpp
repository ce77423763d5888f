// The shape of a delay distribution: deviates of mean 0 and standard deviation 1 (kUniform: half width 1), as
// quantile functions of a uniform number or of a standard normal one. A quantile of a normal number's own
// probability has the same distribution, and lets an AR(1) Gaussian carry a correlation into any shape.
#pragma once

#include <memory>
#include <vector>

#include "netem/link_settings.hpp"

namespace thimble {

class DelayShape {
  public:
    // `delay` is the mean: it decides how skewed kGamma is. That shape is a table made here (about a millisecond);
    // the others compute as they go.
    DelayShape(const JitterSettings& settings, Duration delay);

    // Whether the natural argument is a normal number; if not, a uniform one.
    bool takes_normal() const;
    double at_normal(double z) const;   // any shape
    double at_uniform(double u) const;  // u in [0, 1); shapes whose natural argument is uniform

  private:
    JitterShape shape_;
    std::shared_ptr<const JitterTable> table_;
    struct Node {
        double deviate, slope;
    };
    std::vector<Node> nodes_;  // kGamma: over z, with exact slopes
    double gamma(double z) const;
};

}  // namespace thimble
