// A VirtualSession with devices that a test can break, and a place at the end of every wire where it can listen, cut, or do
// worse.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "cutaneous_node/can/cannelloni.hpp"
#include "cutaneous_node/drive_actuator.hpp"
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
    kScene,             // slave -> visual: picture and beep
    kRecord,            // slave -> session
    kPerceptCutaneous,  // cutaneous -> master
    kPerceptVisual,     // visual -> master
};

// Null: a wire that no test has a name for.
inline std::optional<Wire> wire_to(Port port) {
    if (port <= Port::kSessionNetem) return Wire::kHeartbeats;
    if (port >= Port::kMasterControl && port <= Port::kNetemControl) return Wire::kOrders;
    constexpr std::array kNamed{std::pair{Port::kSlaveNeedle, Wire::kNeedle},
                                std::pair{Port::kMasterForce, Wire::kForceMaster},
                                std::pair{Port::kCutaneousForce, Wire::kForceCutaneous},
                                std::pair{Port::kVisualForce, Wire::kForceVisual},
                                std::pair{Port::kVisualScene, Wire::kScene},
                                std::pair{Port::kSessionRecord, Wire::kRecord},
                                std::pair{Port::kMasterPerceptCutaneous, Wire::kPerceptCutaneous},
                                std::pair{Port::kMasterPerceptVisual, Wire::kPerceptVisual}};
    for (const auto& [to, wire] : kNamed) {
        if (to == port) return wire;
    }
    return std::nullopt;
}

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

// A T(end, arguments...) on each of these wires.
template <class T, class... Arguments>
MakeTap tap_on(std::vector<Wire> wires, Arguments&... arguments) {
    return [wires = std::move(wires), &arguments...](Wire wire, Channel& end) -> std::unique_ptr<Tap> {
        const bool tapped = std::find(wires.begin(), wires.end(), wire) != wires.end();
        return tapped ? std::make_unique<T>(end, arguments...) : nullptr;
    };
}

// Loses everything while `cut` is true.
class Scissors final : public Tap {
  public:
    Scissors(Channel& inner, const bool& cut) : Tap(inner), cut_(&cut) {}
    void send(Bytes datagram) override {
        if (!*cut_) Tap::send(datagram);
    }

  private:
    const bool* cut_;
};

using Hear = std::function<void(const Message&)>;

// Tells of each message that passes.
class Listener final : public Tap {
  public:
    Listener(Channel& inner, const Hear& hear) : Tap(inner), hear_(&hear) {}
    void send(Bytes datagram) override {
        const Decoded decoded = decode(datagram);
        ASSERT_TRUE(decoded.message);
        (*hear_)(*decoded.message);
        Tap::send(datagram);
    }

  private:
    const Hear* hear_;
};

struct Shown {
    SessionTime when;
    Percept percept;
};
using ShownList = std::vector<Shown>;

inline Hear keep_in(ShownList& list) {
    return [&list](const Message& m) { list.push_back({m.header.send_time, std::get<Percept>(m.body)}); };
}

// A handle that may fail; untouched until then.
class BreakableHandle final : public HapticDevice {
  public:
    explicit BreakableHandle(SimulatedHandle& inner) : inner_(&inner) {}
    HandleSample read(SessionTime now) override {
        HandleSample sample = inner_->read(now);
        sample.valid = words.empty();
        return sample;
    }
    void command_force(SessionTime now, double force_hand_N) override {
        commanded_N = words.empty() ? force_hand_N : 0;
        largest_N = std::max(largest_N, std::abs(commanded_N));
        inner_->command_force(now, commanded_N);
    }
    void enable_force(SessionTime now, bool enabled) override { inner_->enable_force(now, enabled); }
    std::string_view fault() const override { return words; }
    bool take_stop(SessionTime /*now*/) override { return false; }
    SessionTime next_look() const override { return inner_->next_look(); }
    std::string words;
    double commanded_N = 0;
    double largest_N = 0;  // of all commands since it was set

  private:
    SimulatedHandle* inner_;
};

// A screen that is read, and a key beside it.
class ReadDisplay final : public Display {
  public:
    explicit ReadDisplay(Duration pipeline) : frames(pipeline) {}
    void draw(SessionTime now, const Scene& scene) override { frames.draw(now, scene); }
    std::optional<ShownScene> shown(SessionTime now) override { return frames.shown(now); }
    SessionTime next_shown() const override { return frames.next_shown(); }
    void turn_page(SessionTime, const Page& turned) override { page = turned; }
    void beep(SessionTime now) override { frames.beep(now); }
    bool take_go_on() override { return std::exchange(pressed, false); }
    std::optional<GivenAnswer> take_answer() override { return frames.take_answer(); }
    bool take_stop() override { return frames.take_stop(); }

    RecordingDisplay frames;
    Page page;
    bool pressed = false;
};

inline void run_until(VirtualSession& session, SessionTime end) {
    while (session.loop().now() < end && session.step()) {
    }
}

inline std::shared_ptr<const LabKey> lab_key_of(std::uint8_t byte) {
    std::array<std::uint8_t, kKeyBytes> bytes{};
    bytes.fill(byte);
    return std::make_shared<const LabKey>(bytes);
}

class Rig {
  public:
    explicit Rig(const SystemSettings& settings, const MakeTap& make_tap = {})
        : settings_(settings),
          handle_(settings.handle, settings.person),
          pointer_(settings.handle),
          actuator_(settings.cutaneous),
          driven_(settings.cutaneous.device == FingertipDevice::kDrives
                      ? std::make_unique<Driven>(settings.cutaneous)
                      : nullptr),
          display_(settings.visual.pipeline),
          virtual_(settings_, nullptr, devices(),
                   [make_tap](Port to, Channel& end) -> std::unique_ptr<Channel> {
                       const std::optional<Wire> wire = make_tap ? wire_to(to) : std::nullopt;
                       return wire ? make_tap(*wire, end) : nullptr;
                   }),
          hand_(virtual_.network().of(Role::kVisual).outlet(Port::kMasterHand)) {
        if (!driven_) return;
        driven_->bus.a.wake(virtual_.loop().wake_mask(), virtual_.bit(Role::kCutaneous));
        driven_->bus.b.wake(virtual_.loop().wake_mask(), virtual_.loop().add(driven_->drives));
    }

    void start(const TrialConditions& conditions) { virtual_.start(conditions); }
    bool step() { return virtual_.step(); }  // false once the trial has ended
    const TrialRecord& finish() {
        while (step()) {
        }
        return session().record();
    }
    const TrialRecord& run(const TrialConditions& conditions) {
        start(conditions);
        return finish();
    }
    // Steps until the session's clock has passed `time`, or the trial has ended.
    void run_until(SessionTime time) {
        while (now() < time && step()) {
        }
    }
    // Steps until there is a sample for which `seen` is true; false if the trial ended before.
    bool run_until_sample(const std::function<bool(const TrajectorySample&)>& seen) {
        const auto& samples = session().record().samples;
        std::size_t looked_at = samples.size();
        while (step()) {
            for (; looked_at < samples.size(); ++looked_at) {
                if (seen(samples[looked_at])) return true;
            }
        }
        return false;
    }
    // Until the needle has touched the fixture for so long.
    bool run_until_contact(double contact_s) {
        return run_until_sample([=](const TrajectorySample& s) { return s.contact_time_s >= contact_s; });
    }

    SessionTime now() const { return virtual_.loop().now(); }
    SessionProcess& session() { return virtual_.session(); }
    SimulatedHandle& handle() { return handle_; }
    // With [handle] device = "pointer": where a person's pointer comes in, and what it draws.
    Channel& hand() { return *hand_; }
    const PointerHandle& pointer() const { return pointer_; }
    // With [cutaneous] device = "drives": the drives at the other end of the bus, and a command for them.
    const EmulatedDrives& drives() const { return driven_->drives; }
    void order_drives(const std::string& words) { driven_->drives.obey(now(), words); }
    const MasterProcess& master() const { return virtual_.master(); }
    const NetemProcess& netem() const { return virtual_.netem(); }
    const SlaveProcess& slave() const { return virtual_.slave(); }
    const CutaneousProcess& cutaneous() const { return virtual_.cutaneous(); }
    const VisualProcess& visual() const { return virtual_.visual(); }
    std::array<const NodeProcess*, 5> nodes() const {
        return {&master(), &netem(), &slave(), &cutaneous(), &visual()};
    }

    // Between trials: lets time pass, presses the subject's key, and what the subject reads.
    void idle(Duration limit) { virtual_.idle(limit); }
    void press_key() { display_.pressed = true; }
    const Page& page() const { return display_.page; }

    // A program that no longer ticks, as one that was killed or stopped with SIGSTOP; it may go on later (what came meanwhile
    // waits, as in a socket), or come up again as another instance (restart_master).
    void freeze(Role role) { virtual_.loop().freeze(virtual_.bit(role)); }
    void thaw(Role role) { virtual_.loop().thaw(virtual_.bit(role)); }
    // The force that the master really asks of the handle at this moment.
    double force_at_handle_N() const { return breakable_.commanded_N; }
    // The largest of all commands to the handle since the last call.
    double take_largest_at_handle_N() { return std::exchange(breakable_.largest_N, 0); }
    double force_at_finger_N() { return actuator_.output(now()).force_N; }
    // From now on the simulated handle has failed, as a real one may, with these words.
    void break_handle(const std::string& words) { breakable_.words = words; }
    // The master's program dies and starts anew, as another instance.
    void restart_master() { virtual_.restart(Role::kMaster); }

    // Over all nodes, since start.
    FlowCounters counters() const {
        FlowCounters sum;
        for (const NodeProcess* node : nodes()) sum.add(node->counters());
        return sum;
    }

  private:
    // The actuator, its drives and the bus between them.
    struct Driven {
        explicit Driven(const CutaneousSettings& s)
            : drives(s.drives.master.nodes, PlantParameters{}, far),
              actuator(s.drives, s.force_limit_N, near) {}

        QueuePipe bus;
        CannelloniBus near{bus.a}, far{bus.b};
        EmulatedDrives drives;
        DriveActuator actuator;
    };
    VirtualDevices devices() {
        VirtualDevices mine;
        const bool simulated = settings_.handle.kind == HandleKind::kSimulated;
        mine.handle = simulated ? static_cast<HapticDevice*>(&breakable_) : &pointer_;
        mine.person = simulated ? static_cast<OperatorPort*>(&handle_) : &pointer_;
        mine.follower = simulated ? nullptr : &pointer_;
        mine.actuator = driven_ ? static_cast<FingertipActuator*>(&driven_->actuator) : &actuator_;
        mine.display = &display_;
        return mine;
    }

    SystemSettings settings_;
    SimulatedHandle handle_;
    BreakableHandle breakable_{handle_};
    PointerHandle pointer_;
    SimulatedActuator actuator_;
    std::unique_ptr<Driven> driven_;
    ReadDisplay display_;
    VirtualSession virtual_;
    Channel* hand_;
};

}  // namespace thimble::test
