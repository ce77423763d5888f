#include "thimble/link_test/link_figures.hpp"

#include <algorithm>

namespace thimble {
namespace {

double missing(std::uint64_t came, std::uint64_t of) {
    if (of == 0) return 0;
    return std::max(0.0, 1 - static_cast<double>(came) / static_cast<double>(of));
}

}  // namespace

double PortFigures::loss_there() const { return missing(far_received, sent); }

// Copies that the network made on the way there are echoed too.
double PortFigures::loss_back() const { return missing(std::uint64_t{returned} + duplicates, far_sent); }

bool LinkFigures::all_answer() const {
    return std::all_of(ports.begin(), ports.end(),
                       [](const PortFigures& port) { return port.answer == PortAnswer::kAnswers; });
}

bool LinkFigures::any_answers() const {
    return std::any_of(ports.begin(), ports.end(),
                       [](const PortFigures& port) { return port.answer == PortAnswer::kAnswers; });
}

LoopFigures loop_figures(const LinkFigures& link) {
    LoopFigures loop;
    for (const PortFigures& port : link.ports) {
        if (!port.traffic.haptic || port.sent == 0) continue;
        loop.measured = true;
        loop.round_trip_median_s = std::max(loop.round_trip_median_s, port.round_trip_median_s);
        loop.round_trip_p99_s = std::max(loop.round_trip_p99_s, port.round_trip_p99_s);
        loop.loss = std::max(loop.loss, missing(port.returned, port.sent));
        loop.longest_gap_s = std::max(loop.longest_gap_s, port.longest_gap_s);
    }
    return loop;
}

}  // namespace thimble
