// A node that does nothing but what every node does, and the session that steers it.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common/node_process.hpp"
#include "common/queue_channel.hpp"

namespace thimble {

// Writes down what is asked of it.
class TinyProcess final : public NodeProcess {
  public:
    explicit TinyProcess(Channel& control) : NodeProcess(Role::kVisual, 42, control) {}

    std::vector<std::string> said;
    SessionTime wanted = kNever;
    std::string fault;         // of its device
    bool needs_peer = false;   // who has never spoken
    bool end_at_once = false;  // finishes in its own work
    StopRequest request;       // its wish that all stop
    using NodeProcess::set_state;

  protected:
    void begin_trial(SessionTime, const SessionControl& control) override {
        said.push_back("begin " + std::to_string(trial()) + ' ' + to_string(control.modality));
    }
    void end_trial(SessionTime) override { said.push_back("end " + std::to_string(trial())); }
    void obey(SessionTime, const SessionControl& control) override {
        said.push_back(control.kind == ControlKind::kFixtureChange ? "fixture" : "beep");
    }
    void network_changed(SessionTime, const SessionControl& control) override {
        said.push_back("delay " + std::to_string(control.network_delay_s) +
                       std::string(control.network.view()));
    }
    void work(SessionTime) override {
        ++works;
        if (running() && end_at_once) set_state(NodeState::kFinished);
    }
    SessionTime next_work() const override { return wanted; }
    InboundFlow* vital_flow() override { return needs_peer ? &peer_ : nullptr; }
    std::string_view device_fault() const override { return fault; }
    StopRequest wants_stop(SessionTime) override { return request; }
    void rest(SessionTime) override { ++rests; }
    void describe(Heartbeat& heartbeat) const override { heartbeat.hold_median_s = 0.25; }

  public:
    int works = 0, rests = 0;

  private:
    InboundFlow peer_{Role::kMaster};
};

class NodeProcessTest : public testing::Test {
  protected:
    NodeProcessTest() {
        near.connect(far);
        far.connect(near);
        tick(std::chrono::milliseconds{0});
        heartbeats();
    }

    void tick(Duration time) {
        now = SessionTime{time};
        process.tick(now);
    }
    // Turns as its loop would, up to `end`, without a message.
    void listen_until(Duration end) {
        while (now < SessionTime{end}) tick(std::min(now.time_since_epoch() + kHeartbeatPeriod, end));
    }
    void order(ControlKind kind, std::uint32_t trial = 1, EndReason reason = EndReason::kNone) {
        SessionControl control;
        control.kind = kind;
        control.modality = Modality::kCF;
        control.reason = reason;
        session.send(now, trial, control);
    }
    // All that was reported since the last call.
    std::vector<Message> heartbeats() {
        std::vector<Message> messages;
        for (Bytes bytes = far.receive(); !bytes.empty(); bytes = far.receive()) {
            const Decoded decoded = decode(bytes);
            EXPECT_TRUE(decoded.message);
            if (decoded.message) messages.push_back(*decoded.message);
        }
        return messages;
    }
    // Exactly one heartbeat, with this trial and state.
    void expect_heartbeat(std::uint32_t trial, NodeState state, EndReason reason = EndReason::kNone) {
        const auto messages = heartbeats();
        ASSERT_EQ(messages.size(), 1U);
        const auto& heartbeat = std::get<Heartbeat>(messages[0].body);
        EXPECT_EQ(messages[0].header.trial, trial);
        EXPECT_EQ(messages[0].header.sender, Role::kVisual);
        EXPECT_EQ(messages[0].header.instance, 42U);
        EXPECT_EQ(heartbeat.state, state);
        EXPECT_EQ(heartbeat.reason, reason);
        EXPECT_EQ(heartbeat.hold_median_s, 0.25);
    }
    void start(std::uint32_t trial = 1) {
        order(ControlKind::kTrialStart, trial);
        tick(std::chrono::milliseconds{10});
        heartbeats();
        process.said.clear();
    }
    using Said = std::vector<std::string>;

    QueueChannel near, far;
    TinyProcess process{near};
    OutboundFlow session{Role::kSession, 1, {&far}};
    SessionTime now{};
};

}  // namespace thimble
