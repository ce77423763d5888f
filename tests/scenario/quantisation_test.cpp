// A slow press on the tissue through the encoder. One count of the handle is 0.03 mm of needle; in one
// millisecond that looks like 30 mm/s, and B times that exceeds the puncture force. Only the velocity filter
// keeps the encoder from piercing what the hand does not.
#include <cmath>

#include <gtest/gtest.h>

#include "master/master_node.hpp"
#include "slave_sim/slave_node.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

constexpr double kPress_needle_m_per_s = 0.010;
constexpr double kDepth_m = 0.008;  // K x + B v stays below the puncture force of 0.1 N

// The first depth at which the tissue gives way, NaN if it holds.
double pierced_at_m(const SystemSettings& settings) {
    MasterNode master(settings.master);
    SlaveNode slave(settings.slave);
    SessionControl order;
    order.fixture_position_m = 0.123;
    master.start_trial({}, Modality::kHF);
    slave.start_trial(order);
    const double surface_m = settings.slave.scene.elements.front().position_m;
    const double scale = settings.master.position_scale, count_m = settings.handle.encoder_resolution_m;
    for (std::uint32_t ms = 0;; ++ms) {
        const double needle_m = surface_m - 0.002 + kPress_needle_m_per_s * 1e-3 * ms;
        if (needle_m > surface_m + kDepth_m) return std::nan("");
        const HandleSample sample{std::round(needle_m / scale / count_m) * count_m, 0};
        const SessionTime now{milliseconds{ms}};
        const ForceFeedback feedback = slave.on_needle(now, ms, master.sample(now, sample));
        if (feedback.phase == TissuePhase::kPenetrated) return needle_m - surface_m;
    }
}

TEST(Quantisation, ASlowPressDoesNotPierceWithTheDefaultEstimator) {
    EXPECT_TRUE(std::isnan(pierced_at_m(paper()))) << pierced_at_m(paper());
}

TEST(Quantisation, WithoutTheFilterTheEncoderPierces) {
    SystemSettings raw = paper();
    raw.master.velocity.method = VelocityMethod::kRaw;
    EXPECT_LT(pierced_at_m(raw), 0.001);
}

// It is the encoder, not the filter's lag: a fine encoder does not pierce even unfiltered.
TEST(Quantisation, AFineEncoderNeedsNoFilter) {
    SystemSettings fine = paper();
    fine.master.velocity.method = VelocityMethod::kRaw;
    fine.handle.encoder_resolution_m = 1e-9;
    EXPECT_TRUE(std::isnan(pierced_at_m(fine)));
}

}  // namespace
}  // namespace thimble::test
