// A measured path as link settings: what a link with few parameters needs to be like it, and how like it that is.
//
// Delay: mean and standard deviation of the received; of the shapes offered the one whose distribution is nearest to
// theirs by the Kolmogorov-Smirnov distance; lag-1 correlation of normal scores, which is the coefficient of the
// link's AR(1) Gaussian. Loss: share p, or where the likelihood ratio of a chain that remembers the packet before
// against one that does not exceeds chance (G test, 1 degree of freedom, 0.1 %), the Gilbert model's p = n01 / n0 and
// r = n10 / n1, its maximum likelihood. Order: not kept if more than half as many packets overtook others as would on a link
// that lets them. Where the path cuts off its only burst one of them would be 0: then the share
// and the length that was seen.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "netem/formats/measured_path.hpp"
#include "netem/link_settings.hpp"

namespace thimble {

struct ShapeFit {
    JitterShape shape = JitterShape::kNone;
    double distance = 0;  // Kolmogorov-Smirnov: largest difference of the two distribution functions, 0 to 1
};

struct PathFit {
    LinkSettings link;
    std::size_t packets = 0, lost = 0;
    double delay_mean_s = 0, delay_sd_s = 0, delay_least_s = 0, delay_most_s = 0;
    double delay_99_s = 0;         // quantile 0.99 of the measured
    std::vector<ShapeFit> shapes;  // the best first
    double correlation = 0;        // as measured, may be negative; the link's is at least 0
    std::size_t reordered = 0;     // received after one that was sent later (RFC 4737)
    std::size_t would_overtake =
        0;                  // of the same packets on the fitted link, if it does not keep their order
    double loss_g = 0;      // likelihood ratio G of memory against none
    double mean_burst = 0;  // lost packets in a row
    std::size_t longest_burst = 0;
    std::string_view burst_cut_at{};     // "beginning" or "end" of the path, which cuts off the only burst
    std::vector<std::string> sentences;  // for people
};

// Throws Error (data) if there are fewer than two packets.
PathFit fit_path(const MeasuredPath& path);
// Throws Error (data): a loss is a probability, as a profile's trace has it. `file` is for the message.
void require_fates(const MeasuredPath& path, const std::string& file);

// Standardised delays as a table, for what no shape fits (print_jitter_table writes it).
std::vector<double> standardised_delays(const MeasuredPath& path);

}  // namespace thimble
