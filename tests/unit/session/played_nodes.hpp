// A session whose five nodes the test plays.
#pragma once

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "common/queue_channel.hpp"
#include "session/run/session_process.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {

inline constexpr Duration kBeat = std::chrono::milliseconds{50};

inline std::size_t place(Role role) {
    return static_cast<std::size_t>(std::find(kNodeRoles.begin(), kNodeRoles.end(), role) -
                                    kNodeRoles.begin());
}

// A node obeys each order at once, unless the test has it do something else.
class PlayedNode {
  public:
    explicit PlayedNode(Role role) : flow_(role, 7, {&pipe.b}) {}

    void tick(SessionTime now) {
        while (const Message* message = orders_.receive(now, pipe.b)) {
            const auto* order = std::get_if<SessionControl>(&message->body);
            if (order == nullptr) continue;
            heard.push_back(order->kind);
            if (obeys) obey(message->header.trial, *order);
        }
        if (!speaks) return;
        Heartbeat heartbeat;
        heartbeat.state = state;
        heartbeat.reason = reason;
        flow_.send(now, trial, heartbeat);
    }
    template <class Body>
    void say(SessionTime now, const Body& body) {
        flow_.send(now, trial, body);
    }
    long count(ControlKind kind) const { return std::count(heard.begin(), heard.end(), kind); }

    QueuePipe pipe;  // a: the session's end
    bool obeys = true, speaks = true;
    NodeState state = NodeState::kIdle;
    EndReason reason = EndReason::kNone;
    std::uint32_t trial = 0;
    std::vector<ControlKind> heard;

  private:
    void obey(std::uint32_t number, const SessionControl& order) {
        if (order.kind == ControlKind::kTrialStart && number != trial) {
            trial = number;
            state = NodeState::kRunning;
        }
        if (order.kind == ControlKind::kTrialEnd && number == trial) state = NodeState::kIdle;
    }

    OutboundFlow flow_;
    InboundFlow orders_{Role::kSession};
};

inline SessionSettings patient_settings() {
    SessionSettings settings;
    settings.contact_hold = std::chrono::seconds{1};
    settings.trial_timeout = std::chrono::seconds{600};
    return settings;
}

class SessionProcessTest : public testing::Test {
  protected:
    explicit SessionProcessTest(const SessionSettings& settings = patient_settings())
        : session_(1, settings,
                   {{&netem_.pipe.a, &slave_.pipe.a, &cutaneous_.pipe.a, &visual_.pipe.a, &master_.pipe.a},
                    &record_.a}) {}

    std::array<PlayedNode*, 5> nodes() { return {&netem_, &slave_, &cutaneous_, &visual_, &master_}; }
    PlayedNode& node(Role role) { return *nodes().at(place(role)); }

    // Nodes speak every 50 ms, and slave_sim answers, until so much time has passed or the trial is over.
    void run_for(Duration time) {
        const SessionTime end = now_ + time;
        while (now_ < end && !session_.finished()) beat();
    }
    void beat() {
        now_ += kBeat;
        if (records_) answer();
        for (PlayedNode* one : nodes()) one->tick(now_);
        session_.tick(now_);
    }
    void answer() {
        ForceFeedback feedback;
        feedback.echo_time = now_;
        feedback.phase = phase_;
        feedback.contact_time_s = contact_s_;
        slave_record_.send(now_, session_.number(), feedback);
    }
    void start(std::uint32_t number = 1) {
        session_.start(TrialConditions{}, number);
        session_.tick(now_);
    }
    void reach_running() {
        start(session_.number() + 1);
        run_for(std::chrono::milliseconds{500});
        ASSERT_TRUE(session_.running());
    }
    void stop_at(Role role, NodeState state, EndReason reason) {
        node(role).obeys = false;
        node(role).state = state;
        node(role).reason = reason;
    }
    const TrialRecord& record() const { return session_.record(); }

    PlayedNode netem_{Role::kNetem}, slave_{Role::kSlaveSim}, cutaneous_{Role::kCutaneous},
        visual_{Role::kVisual}, master_{Role::kMaster};
    SessionTime now_{std::chrono::seconds{100}};
    TissuePhase phase_ = TissuePhase::kContact;
    double contact_s_ = 0;
    bool records_ = true;

  private:
    QueuePipe record_;
    OutboundFlow slave_record_{Role::kSlaveSim, 9, {&record_.b}};

  protected:
    SessionProcess session_;
};

}  // namespace thimble
