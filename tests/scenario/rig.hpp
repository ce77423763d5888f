// A VirtualSession with devices that a test can break, and a place at the end of every wire where it can listen, cut, or do
// worse.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include "cutaneous_node/emulator/emulated_drives.hpp"
#include "master/devices/pointer_handle.hpp"
#include "session/virtual/virtual_session.hpp"

namespace thimble::test {

// Ends of wires, named by who sends there and what.
enum class Wire {
    kOrders,            // session -> nodes, five of them
    kHeartbeats,        // nodes -> session, five of them
    kNeedle,            // netem -> slave
    kForceMaster,       // netem -> master
    kForceCutaneous,    // netem -> cutaneous
    kForceVisual,       // netem -> visual
    kBeep,              // slave -> visual
    kRecord,            // slave -> session
    kPerceptCutaneous,  // cutaneous -> master
    kPerceptVisual,     // visual -> master
};

// A sender's end of a wire. Received datagrams pass untouched.
class Tap : public Channel {
  public:
    explicit Tap(Channel& inner) : inner_(&inner) {}
    void send(Bytes datagram) override { inner_->send(datagram); }

  protected:
    Bytes take() final { return inner_->receive(); }
    Channel& inner() { return *inner_; }

  private:
    Channel* inner_;
};

// Puts a tap on a wire; null leaves it as it is.
using MakeTap = std::function<std::unique_ptr<Tap>(Wire, Channel&)>;

// A handle that may fail; untouched until then.
class BreakableHandle final : public HapticDevice {
  public:
    explicit BreakableHandle(SimulatedHandle& inner) : inner_(&inner) {}
    HandleSample read(SessionTime now) override;
    void command_force(SessionTime now, double force_hand_N) override {
        commanded_N = words.empty() ? force_hand_N : 0;
        largest_N = std::max(largest_N, std::abs(commanded_N));
        inner_->command_force(now, commanded_N);
    }
    void enable_force(SessionTime now, bool enabled) override { inner_->enable_force(now, enabled); }
    std::string_view fault() const override { return words; }
    bool take_stop(SessionTime /*now*/) override { return pressed; }
    SessionTime next_look() const override { return inner_->next_look(); }
    std::string words;
    bool pressed = false;
    double commanded_N = 0;
    double largest_N = 0;  // of all commands since it was set

  private:
    SimulatedHandle* inner_;
};

class Rig {
  public:
    explicit Rig(const SystemSettings& settings, const MakeTap& make_tap = {});
    ~Rig();

    void start(const TrialConditions& conditions);
    bool step();  // false once the trial has ended
    const TrialRecord& finish();
    const TrialRecord& run(const TrialConditions& conditions);
    // Steps until the session's clock has passed `time`, or the trial has ended.
    void run_until(SessionTime time);
    // Steps until there is a sample for which `seen` is true; false if the trial ended before.
    bool run_until_sample(const std::function<bool(const TrajectorySample&)>& seen);

    SessionTime now() const;
    SessionProcess& session();
    SimulatedHandle& handle();
    // With [handle] device = "pointer": where a person's pointer comes in, and what it draws.
    Channel& hand();
    const PointerHandle& pointer() const;
    // With [cutaneous] device = "drives": the drives at the other end of the bus, and a command for them.
    const EmulatedDrives& drives() const;
    void order_drives(const std::string& words);
    const MasterProcess& master() const;
    const NetemProcess& netem() const;
    const SlaveProcess& slave() const;
    const CutaneousProcess& cutaneous() const;
    const VisualProcess& visual() const;
    const RecordingDisplay& display() const;

    // Between trials: lets time pass, presses the subject's key, and what the subject reads.
    void idle(Duration limit);
    void press_key();
    const Page& page() const;

    // A program that no longer ticks, as one that was killed or stopped with SIGSTOP; it may go on later (what came meanwhile
    // waits, as in a socket), or come up again as another instance (restart_master).
    void freeze(Role role);
    void thaw(Role role);
    // The force that the master really asks of the handle at this moment.
    double force_at_handle_N() const;
    // The largest of all commands to the handle since the last call.
    double take_largest_at_handle_N();
    double force_at_finger_N() const;
    // Sends to the stop bus of a program of the rig.
    Channel& stop_channel(Role role);
    // From now on a stop button at the handle is held down.
    void press_handle_button(bool down);

    // From now on the simulated handle has failed, as a real one may, with these words.
    void break_handle(const std::string& words);
    // The master's program dies and starts anew, as another instance.
    void restart_master();

    // Over all nodes, since start.
    FlowCounters counters() const;

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace thimble::test
