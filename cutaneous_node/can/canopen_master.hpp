// Master of the drives on one bus: starts all of them, then exchanges targets and measurements by SYNC. If one of
// them fails, every cable goes slack in the same tick.
#pragma once

#include <boost/core/noncopyable.hpp>

#include "common/histogram.hpp"
#include "cutaneous_node/can/drive_link.hpp"

namespace thimble {

class CanopenMaster : boost::noncopyable {
  public:
    // `bus` outlives the master.
    CanopenMaster(const CanMasterSettings& settings, CanBus& bus);

    // Takes what has arrived, sends what is due. The first call resets the drives.
    void tick(SessionTime now);
    SessionTime next_wakeup() const { return next_; }

    bool operating() const;  // all of them; never again after a fault
    // One of them has left two SYNCs in a row without an answer.
    bool unanswered() const;
    std::size_t drives() const { return links_.size(); }
    const DriveLink& drive(std::size_t i) const { return links_[i]; }
    void set_target(std::size_t i, std::int32_t target) { links_[i].set_target(target); }
    // The first fault; later ones do not replace it.
    const std::optional<DriveFault>& fault() const { return fault_; }
    // A fault that the caller has found. Cables go slack at once.
    void fail(SessionTime now, const DriveFault& fault);
    // Before the program ends: orders no torque and no voltage, twice, and stops the network.
    void stop();

    std::uint64_t cycles() const { return cycles_; }
    std::uint64_t incomplete_cycles() const {
        return incomplete_;
    }  // a drive's answer came after the next SYNC
    std::uint64_t passive_reports() const { return passive_; }
    const Histogram& answered_within() const { return answered_within_; }  // from a SYNC to the last answer
    const CanBus& bus() const { return *bus_; }

  private:
    void take_frames(SessionTime now);
    void take(SessionTime now, const CanFrame& frame);
    void look_at_answers(SessionTime now);
    void cycle(SessionTime now);
    void exchange(bool slack);
    void watch_queue(SessionTime now);

    CanMasterSettings settings_;
    CanBus* bus_;
    std::vector<DriveLink> links_;
    std::array<std::uint8_t, 128> link_of_{};  // by node id; kNoLink
    std::optional<DriveFault> fault_;
    bool begun_ = false;
    bool waiting_ = false;  // for answers to the last SYNC
    SessionTime next_{}, next_heartbeat_{}, sync_{};
    std::uint64_t send_failed_ = 0;  // of the bus, at the last cycle
    int full_ = 0;                   // cycles in a row in which frames could not be sent
    std::uint64_t cycles_ = 0, incomplete_ = 0, passive_ = 0;
    Histogram answered_within_;
};

}  // namespace thimble
