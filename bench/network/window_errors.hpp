// The robust way to speak of lateness on a machine that stalls: the median over short windows of each window's 50 % and
// 99 %. Maxima and raw 99.9 % belong to the host.
#pragma once

#include <cstddef>
#include <vector>

namespace thimble {

struct WindowErrors {
    double w50_us = 0, w99_us = 0;
    double stalled = 0;  // share of windows that hold an error above 1 ms
};

class ErrorWindows {
  public:
    // The errors of one window, a quarter of a second, in microseconds. Less than 20 are not judged.
    void add(std::vector<double> errors_us);
    WindowErrors errors() const;

  private:
    std::vector<double> w50_us_, w99_us_;
    std::size_t stalled_ = 0;
};

double median_of(std::vector<double> values);  // 0 of none

}  // namespace thimble
