#include "visual_node/views/frame_cost.hpp"

namespace thimble {
namespace {

double milliseconds_of(Duration duration) { return static_cast<double>(duration.count()) * 1e-6; }

nlohmann::ordered_json percentiles(const Histogram& cost) {
    return {{"frames", cost.count()},
            {"median_ms", milliseconds_of(cost.quantile(0.5))},
            {"p95_ms", milliseconds_of(cost.quantile(0.95))},
            {"p99_ms", milliseconds_of(cost.quantile(0.99))},
            {"worst_ms", milliseconds_of(cost.worst())}};
}

}  // namespace

nlohmann::ordered_json FrameCost::report(int width, int height) const {
    return {
        {"width", width}, {"height", height}, {"empty", percentiles(empty_)}, {"view", percentiles(view_)}};
}

}  // namespace thimble
