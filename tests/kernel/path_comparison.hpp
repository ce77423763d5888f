// The kernel's netem beside thimble-netem: what both were asked for, what each did, and where they disagree with it or with
// each other. Sound only where time is exact, as in the guest of deploy/kernel-lane: the bounds for time are those of a
// machine that is never late, the others are chance.
#pragma once

#include <string>
#include <vector>

#include "tests/kernel/path_sample.hpp"

namespace thimble {

struct PathRequest {
    double delay_s = 0;
    double normal_s = 0;  // standard deviation of a normal jitter; 0 for a constant delay
    double loss = 0;      // share from 0 to 1, each packet on its own
};

// The most that either way may add to each delay at the guest's 250 million instructions per second: stacks, forwarding, and for
// thimble-netem a wake-up and two system calls. On average, and at most (something else ran just then).
inline constexpr double kPathCost_s = 0.15e-3, kPathMost_s = 0.5e-3;

// Bounds: no mean further from what was asked than 4 standard errors and the path's cost, nor from each other; constant
// delays each within [delay, delay + kPathMost_s]; of normal ones the deviation within 4 of its own (sd / sqrt(2 n)), both
// distributions nearer than Kolmogorov and Smirnov's distance for 1 in 10,000; losses within 4 standard deviations of the binomial, of the request and of each other; shares overtaken within
// 5 standard errors (Student's t with 38 degrees of freedom: 1 in 70,000). No copies, no strangers. A sentence for each breach.
std::vector<std::string> disagreements(const PathRequest& asked, const PathSummary& kernel,
                                       const PathSummary& relay);

double path_distance(const PathSummary& a, const PathSummary& b);  // Kolmogorov and Smirnov's, 0 to 1
double path_distance_by_chance(std::size_t a, std::size_t b);      // exceeded by 1 in 10,000 pairs of samples

// Rows of a markdown table: one for the kernel, one for thimble-netem, whose last cells compare the two.
std::string path_table_head();
std::string path_table_rows(const std::string& name, const PathRequest& asked, const PathSummary& kernel,
                            const PathSummary& relay);

}  // namespace thimble
