// Devices and wires of a virtual session that report each call to a Watch, and fail where the case has a fault.
#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "study/swarm/swarm_case.hpp"
#include "study/swarm/watch.hpp"

namespace thimble {

// For tests: the force that a broken device gives instead of the commanded one.
using BreakForce = std::function<double(const SystemSettings& settings, double force_N)>;

class WatchedHandle final : public HapticDevice {
  public:
    WatchedHandle(SimulatedHandle& inner, Watch& watch, std::function<double(double)> distort)
        : inner_(&inner), watch_(&watch), distort_(std::move(distort)) {}

    HandleSample read(SessionTime now) override {
        HandleSample sample = inner_->read(now);
        sample.valid = words.empty();
        if (no_number) sample.position_hand_m = std::numeric_limits<double>::quiet_NaN();
        watch_->handle_read(now, sample);
        return sample;
    }
    void command_force(SessionTime now, double force_hand_N) override {
        const double told_N = words.empty() ? force_hand_N : 0;
        const double given_N = distort_ ? distort_(told_N) : told_N;
        watch_->handle_commanded(now, given_N);
        inner_->command_force(now, given_N);
    }
    void enable_force(SessionTime now, bool enabled) override {
        watch_->handle_enabled();
        inner_->enable_force(now, enabled);
    }
    std::string_view fault() const override { return words; }
    bool take_stop(SessionTime /*now*/) override { return std::exchange(pressed, false); }
    SessionTime next_look() const override { return inner_->next_look(); }

    std::string words;  // of a fault
    bool pressed = false, no_number = false;

  private:
    SimulatedHandle* inner_;
    Watch* watch_;
    std::function<double(double)> distort_;
};

class WatchedActuator final : public FingertipActuator {
  public:
    WatchedActuator(const CutaneousSettings& settings, Watch& watch) : inner_(settings), watch_(&watch) {}

    void command(SessionTime now, Finger finger, double force_N) override {
        watch_->finger_commanded(now, finger == Finger::kNone ? 0 : force_N);
        inner_.command(now, finger, force_N);
    }
    FingertipForce output(SessionTime now) override {
        const FingertipForce force = inner_.output(now);
        watch_->finger_felt(force.force_N);
        return force;
    }
    void release(SessionTime now) override {
        watch_->finger_commanded(now, 0);
        inner_.release(now);
    }
    void use_hand(SessionTime now, Hand hand) override { inner_.use_hand(now, hand); }
    void tick(SessionTime now) override { inner_.tick(now); }
    SessionTime next_wakeup() const override { return inner_.next_wakeup(); }
    std::string_view fault() const override { return inner_.fault(); }

  private:
    SimulatedActuator inner_;
    Watch* watch_;
};

class WatchedDisplay final : public Display {
  public:
    WatchedDisplay(Duration pipeline, Watch& watch) : inner_(pipeline), watch_(&watch) {}

    void draw(SessionTime now, const Scene& scene) override {
        watch_->bar_drawn(now, scene);
        inner_.draw(now, scene);
    }
    std::optional<ShownScene> shown(SessionTime now) override { return inner_.shown(now); }
    SessionTime next_shown() const override { return inner_.next_shown(); }
    void turn_page(SessionTime now, const Page& page) override { inner_.turn_page(now, page); }
    void beep(SessionTime now) override { inner_.beep(now); }
    bool take_go_on() override { return inner_.take_go_on(); }
    std::optional<GivenAnswer> take_answer() override { return inner_.take_answer(); }
    bool take_stop() override { return inner_.take_stop(); }

  private:
    RecordingDisplay inner_;
    Watch* watch_;
};

// The sender's end of a wire. Its faults act while they are in `active`.
class WatchedWire final : public Channel {
  public:
    WatchedWire(Channel& inner, Port to, Watch& watch, const std::vector<const SwarmFault*>& active,
                const SessionTime& now, RandomStream& draw)
        : inner_(&inner), to_(to), watch_(&watch), active_(&active), now_(&now), draw_(&draw) {}

    void send(Bytes datagram) override;

  private:
    struct Kept {
        std::vector<std::uint8_t> bytes;
        SessionTime since;
    };
    Bytes take() override { return inner_->receive(); }
    void pass(Bytes datagram);
    void pass_late(Duration by);
    void pass_kept();
    void keep(Bytes datagram) { kept_.push_back({{datagram.begin(), datagram.end()}, *now_}); }
    void flip(Bytes datagram);
    void put_stamp_off(Bytes datagram, bool back);
    void suffer(const SwarmFault& fault, Bytes datagram);

    Channel* inner_;
    Port to_;
    Watch* watch_;
    const std::vector<const SwarmFault*>* active_;
    const SessionTime* now_;
    RandomStream* draw_;
    std::deque<Kept> kept_{};
    Encoder encoder_{};
};

}  // namespace thimble
