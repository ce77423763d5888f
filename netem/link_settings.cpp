#include "netem/link_settings.hpp"

namespace thimble {
namespace {

// Share of the packets that find the chain in "bad".
double in_bad(const LossSettings& loss) {
    const double moves = loss.good_to_bad + loss.bad_to_good;
    return moves > 0 ? loss.good_to_bad / moves : 0;
}

// Balance: pi1 p14 = pi4; pi1 p13 + pi2 p23 = pi3 (p31 + p32); pi3 p32 = pi2 p23.
double four_state_loss(const LossSettings& loss) {
    if (loss.p13 == 0) return loss.p14 / (1 + loss.p14);
    const double lost_alone = loss.p14;  // all relative to state 1
    const double lost_in_burst = loss.p13 / loss.p31;
    const double received_in_burst = loss.p23 > 0 ? lost_in_burst * loss.p32 / loss.p23 : 0;
    return (lost_alone + lost_in_burst) / (1 + lost_alone + lost_in_burst + received_in_burst);
}

}  // namespace

LossSettings LossSettings::independent(double probability) {
    LossSettings loss;
    loss.shape = probability > 0 ? LossShape::kIndependent : LossShape::kNone;
    loss.probability = probability;
    return loss;
}

double stationary_loss(const LossSettings& loss) {
    switch (loss.shape) {
        case LossShape::kNone:
            return 0;
        case LossShape::kIndependent:
            return loss.probability;
        case LossShape::kGilbertElliott:
            return loss.loss_in_good + in_bad(loss) * (loss.loss_in_bad - loss.loss_in_good);
        case LossShape::kFourState:
            return four_state_loss(loss);
    }
    return 0;
}

}  // namespace thimble
