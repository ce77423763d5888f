#include "netem/stages/outage.hpp"

#include <algorithm>

namespace thimble {

bool is_out(const std::vector<Outage>& outages, Duration time) {
    return std::any_of(outages.begin(), outages.end(), [&](const Outage& outage) {
        if (time < outage.start) return false;
        const Duration since = time - outage.start;
        return (outage.every > Duration::zero() ? since % outage.every : since) < outage.length;
    });
}

}  // namespace thimble
