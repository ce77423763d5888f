// How many packets a link loses by chance: the exact distribution of that number, for any loss model, timeline and trace.
// Packet by packet the probability of each number lost so far is followed, together with the state of the loss chain.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "netem/packet_trace.hpp"
#include "netem/relay/selftest_twin.hpp"

namespace thimble {

inline constexpr double kNextToImpossible = 1e-25;

class LossLaw {
  public:
    // `received`: when each packet came, not decreasing. Takes time in proportion to packets times losses expected.
    LossLaw(const TwinLink& link, std::span<const SessionTime> received) : share_(received.size() + 1) {
        share_[0] = {1};
        const LinkSettings* settings = &link.settings;
        Chain chain(settings->loss);
        bool begun = false;
        std::size_t next_change = 0;
        for (std::size_t packet = 0; packet < received.size(); ++packet) {
            const Duration time = received[packet] - link.start;
            for (; next_change < link.timeline.size() && time >= link.timeline[next_change].at;
                 ++next_change) {
                const LinkSettings& later = link.timeline[next_change].settings;
                if (later.loss != settings->loss) {
                    chain = Chain(later.loss);
                    begun = false;
                }
                settings = &later;
            }
            if (settings->trace != nullptr && settings->trace->layout().has_loss) {
                const double loss = settings->trace->of(packet, time).loss;
                lose({loss, loss, loss, loss});
            } else {
                begun ? move(chain) : begin(chain);
                begun = true;
                lose(chain.lost);
            }
            trim();
        }
    }

    double mean() const {
        double sum = 0;
        for (std::size_t lost = low_; lost <= high_; ++lost) sum += static_cast<double>(lost) * at(lost);
        return sum;
    }

    // Of links with other seeds, the share that loses a number as far out as this one, on either side: 0 to 1.
    double chance_of(std::uint64_t lost) const {
        double so_few = 0, so_many = 0;
        for (std::size_t other = low_; other <= high_; ++other) {
            so_few += other <= lost ? at(other) : 0;
            so_many += other >= lost ? at(other) : 0;
        }
        return std::min(1.0, 2 * std::min(so_few, so_many));
    }

  private:
    using States = std::array<double, 4>;
    // Where a packet is lost with the probability of the state it finds. Fewer states: the others are never reached.
    struct Chain {
        explicit Chain(const LossSettings& settings) {
            switch (settings.shape) {
                case LossShape::kNone:
                    return;
                case LossShape::kIndependent:
                    lost = {settings.probability};
                    return;
                case LossShape::kGilbertElliott: {
                    const double bad = share_in_bad(settings);
                    stationary = {1 - bad, bad};
                    lost = {settings.loss_in_good, settings.loss_in_bad};
                    move[0] = {1 - settings.good_to_bad, settings.good_to_bad};
                    move[1] = {settings.bad_to_good, 1 - settings.bad_to_good};
                    return;
                }
                case LossShape::kFourState:
                    stationary = four_state_shares(settings);
                    lost = {0, 0, 1, 1};
                    move[0] = {1 - settings.p13 - settings.p14, 0, settings.p13, settings.p14};
                    move[1] = {0, 1 - settings.p23, settings.p23, 0};
                    move[2] = {settings.p31, settings.p32, 1 - settings.p31 - settings.p32, 0};
                    move[3] = {1, 0, 0, 0};
                    return;
            }
        }

        States stationary{1}, lost{};
        std::array<States, 4> move{{{1}}};  // from, to
    };

    void begin(const Chain& chain) {
        for (std::size_t lost = low_; lost <= high_; ++lost) {
            const double all = at(lost);
            for (std::size_t s = 0; s < 4; ++s) share_[lost][s] = all * chain.stationary[s];
        }
    }

    void move(const Chain& chain) {
        for (std::size_t lost = low_; lost <= high_; ++lost) {
            const States before = std::exchange(share_[lost], {});
            for (std::size_t from = 0; from < 4; ++from) {
                for (std::size_t to = 0; to < 4; ++to)
                    share_[lost][to] += before[from] * chain.move[from][to];
            }
        }
    }

    void lose(const States& probability) {
        ++high_;
        for (std::size_t s = 0; s < 4; ++s) {
            for (std::size_t lost = high_; lost > low_; --lost)
                share_[lost][s] =
                    share_[lost][s] * (1 - probability[s]) + share_[lost - 1][s] * probability[s];
            share_[low_][s] *= 1 - probability[s];
        }
    }

    void trim() {
        for (; high_ > low_ && at(high_) < kNextToImpossible; --high_) share_[high_] = {};
        for (; low_ < high_ && at(low_) < kNextToImpossible; ++low_) share_[low_] = {};
    }

    double at(std::size_t lost) const {
        const States& share = share_[lost];
        return share[0] + share[1] + share[2] + share[3];
    }

    std::vector<States> share_;       // by number lost, then by state
    std::size_t low_ = 0, high_ = 0;  // numbers outside are next to impossible
};

}  // namespace thimble
