// Clocks that are wrong by seconds, drift and step, behind networks that delay both ways differently and lose packets: what
// the session says about them is always within its own bound.
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "common/queue_channel.hpp"
#include "netem/link_model.hpp"
#include "session/clocks/clock_summary.hpp"
#include "session/run/session_process.hpp"
#include "session/virtual/virtual_loop.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

struct ClockFault {
    Duration offset{};
    int ppm = 0;
    SessionTime step_at = kNever;
    Duration step{};

    SessionTime far(SessionTime near) const {
        const Duration drift{near.time_since_epoch().count() / 1'000'000 * ppm};
        return near + offset + drift + (near >= step_at ? step : Duration{});
    }
};

// Does nothing but what every node does.
class IdleNode final : public NodeProcess {
  public:
    IdleNode(Role role, Channel& control) : NodeProcess(role, 100 + static_cast<unsigned>(role), control) {}

  protected:
    void begin_trial(SessionTime, const SessionControl&) override {}
    void end_trial(SessionTime) override {}
    void work(SessionTime) override {}
    SessionTime next_work() const override { return kNever; }
};

// A process that lives by a clock of its own.
class Abroad final : public Process {
  public:
    Abroad(Process& inner, const ClockFault& fault) : inner_(&inner), fault_(fault) {}
    void tick(SessionTime now) override {
        now_ = now;
        inner_->tick(fault_.far(now));
    }
    SessionTime next_wakeup() const override {
        const SessionTime wanted = inner_->next_wakeup();
        if (wanted == kNever) return kNever;
        if (wanted <= fault_.far(now_)) return now_;
        const SessionTime guess = now_ + (wanted - fault_.far(now_));
        if (now_ < fault_.step_at && guess >= fault_.step_at) return fault_.step_at;
        return std::max(now_ + Duration{1}, guess - std::max(fault_.far(guess) - wanted, Duration{}));
    }
    bool stopped() const override { return false; }

  private:
    Process* inner_;
    ClockFault fault_;
    SessionTime now_{};
};

// A control channel through two links.
class Wan final : public Process {
  public:
    Wan(const LinkSettings& there, const LinkSettings& back, std::uint32_t direction)
        : there_(there, {1, 1, 1, 1}, direction), back_(back, {1, 1, 1, 1}, direction + 1) {}
    void tick(SessionTime now) override {
        relay(now, session.b, there_, node.a);
        relay(now, node.a, back_, session.b);
    }
    SessionTime next_wakeup() const override { return std::min(there_.next_due(), back_.next_due()); }
    bool stopped() const override { return false; }

    QueuePipe session, node;  // a is nearer to the session

  private:
    static void relay(SessionTime now, Channel& in, LinkModel& link, Channel& out) {
        for (Bytes bytes = in.receive(); !bytes.empty(); bytes = in.receive()) link.push(now, bytes);
        for (Bytes bytes = link.pop_due(now); !bytes.empty(); bytes = link.pop_due(now)) out.send(bytes);
    }
    LinkModel there_, back_;
};

class World {
  public:
    using Faults = std::array<ClockFault, kNodeRoles.size()>;  // as kNodeRoles

    World(const Faults& faults, const LinkSettings& there, const LinkSettings& back) : faults_(faults) {
        SessionProcess::Channels channels{};
        channels.record = &record_.b;
        for (std::size_t i = 0; i < kNodeRoles.size(); ++i) {
            wans_[i] = std::make_unique<Wan>(there, back, static_cast<std::uint32_t>(2 * i));
            nodes_[i] = std::make_unique<IdleNode>(kNodeRoles[i], wans_[i]->node.b);
            abroad_[i] = std::make_unique<Abroad>(*nodes_[i], faults[i]);
            channels.control[i] = &wans_[i]->session.a;
        }
        session_ = std::make_unique<SessionProcess>(1, SessionSettings{}, channels);
        session_->set_clock_hook([this](Role role, const ClockExchange& e) { look(role, e); });
        wire();
    }
    void run_until(SessionTime end) {
        while (loop_.now() < end && loop_.step()) {
        }
    }
    SessionProcess& session() { return *session_; }
    const std::vector<ClockExchange>& exchanges(std::size_t i) const { return exchanges_[i]; }
    double worst_error_s = 0;
    int outside = 0;  // estimates whose bound does not hold

  private:
    void wire() {
        const std::uint32_t session_bit = loop_.add(*session_);
        for (std::size_t i = 0; i < kNodeRoles.size(); ++i) {
            const std::uint32_t wan_bit = loop_.add(*wans_[i]), node_bit = loop_.add(*abroad_[i]);
            wans_[i]->session.a.wake(loop_.wake_mask(), session_bit);
            wans_[i]->session.b.wake(loop_.wake_mask(), wan_bit);
            wans_[i]->node.a.wake(loop_.wake_mask(), wan_bit);
            wans_[i]->node.b.wake(loop_.wake_mask(), node_bit);
        }
    }
    // An exchange under way while the clock is set is about both offsets.
    void look(Role role, const ClockExchange& e) {
        const auto i = static_cast<std::size_t>(std::find(kNodeRoles.begin(), kNodeRoles.end(), role) -
                                                kNodeRoles.begin());
        exchanges_[i].push_back(e);
        const ClockFault& fault = faults_[i];
        if (e.sent < fault.step_at && fault.step_at <= e.answered) return;
        const double truth_s = to_seconds(fault.far(e.answered) - e.answered);
        const OffsetInterval said = *session_->clock_of(role).at(e.answered);
        if (truth_s < said.low_s - 2e-9 || truth_s > said.high_s + 2e-9) ++outside;
        worst_error_s = std::max(worst_error_s, std::abs(said.offset_s() - truth_s));
    }

    Faults faults_;
    QueuePipe record_;
    std::array<std::unique_ptr<Wan>, kNodeRoles.size()> wans_;
    std::array<std::unique_ptr<IdleNode>, kNodeRoles.size()> nodes_;
    std::array<std::unique_ptr<Abroad>, kNodeRoles.size()> abroad_;
    std::unique_ptr<SessionProcess> session_;
    VirtualLoop loop_;
    std::array<std::vector<ClockExchange>, kNodeRoles.size()> exchanges_;
};

LinkSettings link(Duration delay, double loss = 0, Duration jitter = {}) {
    LinkSettings settings;
    settings.delay = delay;
    settings.loss = LossSettings::independent(loss);
    if (jitter > Duration{}) {
        settings.jitter.shape = JitterShape::kUniform;
        settings.jitter.spread = jitter;
        settings.in_order = false;
    }
    return settings;
}

World::Faults wrong_clocks() {
    return {{{seconds{7}, 50},
             {seconds{3600}, -50},
             {milliseconds{1}, 50},
             {Duration{1}, -50},
             {seconds{90}, 0}}};
}

TEST(Clocks, AsymmetricDelayJitterAndLossStayWithinTheBound) {
    World world(wrong_clocks(), link(milliseconds{5}, 0.2, milliseconds{4}),
                link(milliseconds{45}, 0.2, milliseconds{30}));
    world.run_until(SessionTime{seconds{120}});
    EXPECT_EQ(world.outside, 0);
    // The middle is wrong by half of the asymmetry: without the bound it would mislead.
    EXPECT_GT(world.worst_error_s, 0.005);
    for (std::size_t i = 0; i < kNodeRoles.size(); ++i) {
        const ClockSummary summary = summarize_clock(world.exchanges(i));
        EXPECT_GT(summary.exchanges, 200U);
        EXPECT_EQ(summary.steps, 0U);
        ASSERT_TRUE(summary.even);
        EXPECT_LE(summary.rate_low, 1e-6 * wrong_clocks()[i].ppm);
        EXPECT_GE(summary.rate_high, 1e-6 * wrong_clocks()[i].ppm);
        EXPECT_LT(summary.rate_high - summary.rate_low, 1e-3);
        EXPECT_LT(summary.offset->bound_s(), 0.025);
        const ClockProbeCounters& counters = world.session().peer(kNodeRoles[i]).prober().counters();
        EXPECT_LT(counters.exchanges, counters.probes);  // some were lost
        EXPECT_EQ(counters.impossible, 0U);
    }
}

TEST(Clocks, AStepIsNoticedByWhoSteppedOnly) {
    World::Faults faults = wrong_clocks();
    faults[1].step_at = SessionTime{seconds{20}};
    faults[1].step = milliseconds{200};
    World world(faults, link(milliseconds{20}), link(milliseconds{30}));
    world.run_until(SessionTime{seconds{40}});
    EXPECT_EQ(world.outside, 0);
    for (std::size_t i = 0; i < kNodeRoles.size(); ++i) {
        EXPECT_EQ(world.session().clock_of(kNodeRoles[i]).steps(), i == 1 ? 1U : 0U);
        EXPECT_EQ(summarize_clock(world.exchanges(i)).steps, i == 1 ? 1U : 0U);
    }
}

}  // namespace
}  // namespace thimble::test
