// The fates of numbered datagrams on one way through a network, as a file and as a few numbers. Then the kernel's netem beside
// thimble-netem: where each disagrees with the request, and where they disagree with each other. The bounds hold only where time
// is exact, as in the guest of deploy/kernel-lane. Those for time are the bounds of a machine that is never late.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/time.hpp"

namespace thimble {

struct PathPacket {
    bool arrived = false;
    bool overtaken = false;  // arrived after one that was sent later
    Duration delay{};        // from sending to the receiving kernel's stamp, if it arrived
};

struct PathSample {
    std::vector<PathPacket> packets;  // by number, in the order of sending
    std::uint64_t copies = 0;         // arrived a second time; the first counts
    std::uint64_t strangers = 0;      // carried no number of these
    std::uint64_t untrusted = 0;      // stamps of the kernel that cannot be
};

// Text: "copies,strangers,untrusted" in the first line, then "delay_ns,overtaken" for each packet, an empty line for one
// that never arrived. Throws Error (run failed).
void write_path_sample(const PathSample& sample, const std::string& file);
// Throws Error (data) that names file and line.
PathSample read_path_sample(const std::string& file);

struct PathSummary {
    std::size_t sent = 0, lost = 0;
    std::uint64_t copies = 0, strangers = 0, untrusted = 0;
    std::vector<double> sorted_s;  // delays
    double mean_s = 0;
    double deviation_s = 0;  // of the sample, over n - 1
    double overtaken = 0;    // share of what was sent
    // Standard error of that share from the means of 20 batches in the order of sending: who is overtaken depends on the
    // neighbours, so that p (1 - p) / n would be wrong (method of batch means; Law, Simulation Modeling and Analysis, 9.5.3).
    double overtaken_error = 0;

    double loss() const { return sent == 0 ? 0 : static_cast<double>(lost) / static_cast<double>(sent); }
    double quantile_s(double q) const;  // q from 0 to 1; 0 if nothing arrived
    double mean_error_s() const;  // standard error of the mean, for independent delays; 0 if nothing arrived
};

PathSummary summarise(const PathSample& sample);

struct PathRequest {
    double delay_s = 0;
    double normal_s = 0;  // standard deviation of a normal jitter; 0 for a constant delay
    double loss = 0;      // share from 0 to 1, each packet on its own
};

// The most that either way may add to each delay at the guest's 250 million instructions per second: stacks, forwarding, and for
// thimble-netem a wake-up and two system calls. On average, and at most (something else ran just then).
inline constexpr double kPathCost_s = 0.15e-3, kPathMost_s = 0.5e-3;

// Returns a sentence for each bound that is broken:
// - Means differ from the request and from each other by at most 4 standard errors and the path's cost.
// - Each constant delay is within [delay, delay + kPathMost_s].
// - The deviation of normal delays is within 4 of its own deviations, sd / sqrt(2 n).
// - Both distributions are nearer than Kolmogorov and Smirnov's distance for 1 in 10,000.
// - Losses differ from the request and from each other by at most 4 standard deviations of the binomial.
// - Shares overtaken differ by at most 5 standard errors (Student's t with 38 degrees of freedom: 1 in 70,000).
// - There are no copies and no foreign packets.
std::vector<std::string> disagreements(const PathRequest& asked, const PathSummary& kernel,
                                       const PathSummary& relay);

double path_distance(const PathSummary& a, const PathSummary& b);  // Kolmogorov and Smirnov's, 0 to 1
double path_distance_by_chance(std::size_t a, std::size_t b);      // exceeded by 1 in 10,000 pairs of samples

// Rows of a markdown table: one for the kernel, one for thimble-netem, whose last cells compare the two.
std::string path_table_head();
std::string path_table_rows(const std::string& name, const PathRequest& asked, const PathSummary& kernel,
                            const PathSummary& relay);

}  // namespace thimble
