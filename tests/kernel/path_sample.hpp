// The fates of numbered datagrams on one way through a network: the one-way delay of each, as a file and as a few numbers.
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

}  // namespace thimble
