// Four channels with a model at each end (architecture: Lawrence 1993; models: Mitra and Niemeyer 2008). Positions and forces travel both
// ways, and no loop is closed over the network by a force:
//
// At the slave the needle is where the hand was, but yields to a difference of forces. The fixture K is solved for together with it.
//
//     k (x_s - x_m) = F_m - F_other - K (x_s - plane)^+        k: coupling_N_per_m, F_m: the handle's force
//
// The needle is at x_m as soon as both ends agree on the force.
//
// The master renders a spring of its own where pairs (x_s, F) of the slave say the fixture is (local_fixture.hpp). Tissue acts as it comes.
//
// The needle leaves the hand by (F_m - F_e) / k at most, 1 mm for 20 N at the default. Not passive: K h / 2 of the
// local spring must be below the hand's damping, as with local-fixture. F positive pushes the hand out. SI units,
// frame: hand.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/control/built_in_controllers.hpp"
#include "common/control/local_fixture_end.hpp"

namespace thimble {
namespace {

class FourChannelHandle : public LocalFixtureEnd {
  public:
    using LocalFixtureEnd::LocalFixtureEnd;
    void sample(const thimble_handle& handle, thimble_packet& out) {
        LocalFixtureEnd::sample(handle, out);
        out.value[0] = handle.force_hand_N;
        out.count = 1;
    }
    void hear(const thimble_packet& /*packet*/) {}
};

class FourChannelSlave {
  public:
    explicit FourChannelSlave(const thimble_controller_settings& s)
        : settings_(s), coupling_N_per_m_(s.values[kLocalFixtureKeys.size()]) {}
    void start() { force_hand_N_ = position_hand_m_ = 0; }
    std::uint32_t receive(const thimble_command& command, const thimble_packet& packet) {
        if (command.newer == 0) return 0;
        position_hand_m_ = command.position_hand_m;
        force_hand_N_ = limited_N(packet.value[0], settings_);
        return 1;
    }
    double step_m(const thimble_surroundings& s) const {
        const double free_m = position_hand_m_ + (force_hand_N_ - s.other_force_hand_N) / coupling_N_per_m_;
        const double beyond_m = free_m - s.plane_hand_m;
        if (beyond_m <= 0) return free_m;
        return s.plane_hand_m + beyond_m * coupling_N_per_m_ / (coupling_N_per_m_ + s.stiffness_hand_N_per_m);
    }
    void answer(const thimble_feedback& felt, thimble_packet& out) const {
        out.value[0] = felt.force_total_hand_N;
        out.count = 1;
    }
    void hold() { force_hand_N_ = 0; }

  private:
    thimble_controller_settings settings_;
    double coupling_N_per_m_;
    double position_hand_m_ = 0, force_hand_N_ = 0;  // of the master's sample
};

constexpr std::array kFourChannelKeys{
    kLocalFixtureKeys[0], kLocalFixtureKeys[1], kLocalFixtureKeys[2], kLocalFixtureKeys[3],
    thimble_controller_key{"coupling_N_per_m", kByDefault.coupling_N_per_m, 100, 1e6,
                           "Stiffness between hand and needle: their distance is the difference of their "
                           "forces divided by it."}};

}  // namespace

const thimble_controller& four_channel_controller() {
    static const thimble_controller kTable = with_slave<FourChannelSlave>(
        with_packets<FourChannelHandle>(with_memory<FourChannelHandle>(with_handle<FourChannelHandle>(
            named("four-channel", "Lawrence 1993; Mitra and Niemeyer 2008", kFourChannelKeys)))));
    return kTable;
}

}  // namespace thimble
