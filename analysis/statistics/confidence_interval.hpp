#pragma once

namespace thimble {

struct ConfidenceInterval {
    double low = 0;
    double high = 0;
};

}  // namespace thimble
