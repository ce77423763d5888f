// A real handle whose device a thread of this process talks to: the maker's service answers when it likes (haply/), or the maker's
// library calls back (touch/). Both give positions to a DeviceMailbox and take forces from it. RemoteHandle judges the positions.
#pragma once

#include <string>

#include "master/devices/axis_constraint.hpp"
#include "master/devices/device_mailbox.hpp"
#include "master/devices/remote_handle.hpp"

namespace thimble {

class MailboxHandle : public RemoteHandle {
  public:
    // `name` says which device it is, for the log and for faults. `stop_buttons`: as DeviceMailbox gives them. `mailbox` outlives
    // this.
    MailboxHandle(const AxisSettings& axis, double force_limit_N, std::uint32_t stop_buttons,
                  std::string name, DeviceMailbox& mailbox);
    ~MailboxHandle() override;

    // No force comes back without a restart: a device that failed stays failed.
    void start_trial(SessionTime now, const OperatorTask& task) override;
    // Also updates the lateral virtual constraint, which depends on the position.
    HandleSample read(SessionTime now) override;
    void enable_force(SessionTime now, bool enabled) override;
    bool take_stop(SessionTime now) override;
    std::string name() const override { return name_; }
    // Ready once a position has arrived. Throws Error (run failed) if the device is lost.
    std::string awaits() override;
    void describe(nlohmann::ordered_json& report) const override;

  protected:
    // The user's next step before use; empty: none.
    virtual std::string next_step() { return {}; }

  private:
    void listen(SessionTime now) override;
    void tell_force(double force_hand_N) override;
    std::string driver() const override { return name_; }
    std::string remedy() const override { return "Then start thimble-master again."; }

    std::string name_;
    std::uint32_t stop_buttons_;
    DeviceMailbox* mailbox_;
    AxisConstraint axis_;
    std::uint32_t reports_ = 0;
    std::uint64_t withheld_ticks_ = 0;
};

}  // namespace thimble
