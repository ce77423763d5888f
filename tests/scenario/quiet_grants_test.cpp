// Lock-step wakes visual for its frames and for a beep, master and cutaneous for their own times. A new flow must not change that
// unnoticed.
#include <memory>
#include <variant>

#include <gtest/gtest.h>

#include "common/codec.hpp"
#include "session/virtual/lock_step_session.hpp"
#include "session/virtual/virtual_session.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

struct Sent {
    DatagramCounts datagrams{};
    bool beep = false;
};

class CountingTap final : public Channel {
  public:
    CountingTap(Port to, Channel& end, Sent& sent) : to_(to), end_(&end), sent_(&sent) {}
    void send(Bytes datagram) override {
        const Decoded decoded = decode(datagram);
        const auto* order = decoded.message ? std::get_if<SessionControl>(&decoded.message->body) : nullptr;
        sent_->beep = sent_->beep || (order != nullptr && order->kind == ControlKind::kBeep);
        ++sent_->datagrams.at(static_cast<std::size_t>(to_));
        end_->send(datagram);
    }

  private:
    Bytes take() override { return end_->receive(); }

    Port to_;
    Channel* end_;
    Sent* sent_;
};

TEST(QuietGrants, MailForVisualIsQuietButForBeepsAndOrders) {
    Sent sent;
    VirtualSession session(paper(), nullptr, {}, [&sent](Port to, Channel& end) {
        return std::make_unique<CountingTap>(to, end, sent);
    });
    std::uint32_t woken = 0;
    AnnouncedMail mail(&woken);
    mail.wake(Role::kVisual, 1);
    int quiet = 0, full = 0, beeps = 0;
    session.start(trial_of(Modality::kVF));
    while (session.step()) {
        woken = 0;
        mail.post(sent.datagrams);
        if (woken != 0) ++(mail.only_data(Role::kVisual) ? quiet : full);
        beeps += sent.beep ? 1 : 0;
        EXPECT_FALSE(sent.beep && mail.only_data(Role::kVisual))
            << to_seconds(session.now().time_since_epoch());
        sent = {};
        DatagramCounts taken{};
        mail.take(Role::kVisual, taken);
    }
    EXPECT_GE(beeps, 1);
    EXPECT_GT(quiet, 50 * full) << quiet << " of " << quiet + full;
}

TEST(QuietGrants, NeedlesAndOrdersAreAnswered) {
    std::uint32_t woken = 0;
    const auto quiet = [&woken](Role role, Port port) {
        AnnouncedMail mail(&woken);
        DatagramCounts sent{};
        sent.at(static_cast<std::size_t>(port)) = 1;
        mail.post(sent);
        return mail.only_data(role);
    };
    EXPECT_TRUE(quiet(Role::kMaster, Port::kMasterForce));
    EXPECT_TRUE(quiet(Role::kMaster, Port::kMasterPerceptCutaneous));
    EXPECT_TRUE(quiet(Role::kCutaneous, Port::kCutaneousForce));
    EXPECT_FALSE(quiet(Role::kNetem, Port::kNetemForceMaster));
    EXPECT_FALSE(quiet(Role::kSlaveSim, Port::kSlaveNeedle));
    EXPECT_FALSE(quiet(Role::kMaster, Port::kMasterControl));
    EXPECT_FALSE(quiet(Role::kCutaneous, Port::kCutaneousStop));
}

}  // namespace
}  // namespace thimble::test
