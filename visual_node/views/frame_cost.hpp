// How long frames take to draw, as JSON: of the view and of an empty window in the same run, because only their ratio means
// something on a busy machine.
#pragma once

#include <nlohmann/json.hpp>

#include "common/histogram.hpp"

namespace thimble {

class FrameCost {
  public:
    void add_empty(Duration cost) { empty_.add(cost); }
    void add_view(Duration cost) { view_.add(cost); }
    // Milliseconds.
    nlohmann::ordered_json report(int width, int height) const;

  private:
    Histogram empty_, view_;
};

}  // namespace thimble
