// Programs that die or stand still, links that are cut, late, shuffled or almost deaf, clocks that jump, at random instants of
// many trials: no force above its limit, none beyond its time, no trial that never ends, and the next one runs. How many:
// THIMBLE_FAULT_TRIALS (docs/reliability.md).
#include <array>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common/random.hpp"
#include "tests/scenario/rig.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

enum class Fault { kKill, kStandStill, kCut, kLate, kShuffled, kDeaf, kClock };
constexpr std::array kFaults{Fault::kKill,     Fault::kStandStill, Fault::kCut,  Fault::kLate,
                             Fault::kShuffled, Fault::kDeaf,       Fault::kClock};
constexpr std::array kFaultNames{"killed",   "stopped for a while", "cut",          "late by seconds",
                                 "shuffled", "90 % lost",           "clock stepped"};
constexpr std::array kVictims{Role::kSession,   Role::kMaster, Role::kSlaveSim,
                              Role::kCutaneous, Role::kVisual, Role::kNetem};
constexpr std::array kWires{Wire::kOrders,      Wire::kHeartbeats,       Wire::kNeedle,
                            Wire::kForceMaster, Wire::kForceCutaneous,   Wire::kForceVisual,
                            Wire::kRecord,      Wire::kPerceptCutaneous, Wire::kPerceptVisual};

struct FaultPlan {
    Fault fault = Fault::kKill;
    Role victim = Role::kMaster;
    Wire wire = Wire::kNeedle;
    Modality modality = Modality::kHF;
    Duration begin{};
    Duration length{};  // of kStandStill and kLate
};

FaultPlan draw_plan(std::uint32_t number) {
    RandomStream stream({4711, 0, 0, number, Purpose::kInstance});
    const auto pick = [&](std::size_t count) {
        return std::min(count - 1, static_cast<std::size_t>(stream.uniform() * static_cast<double>(count)));
    };
    FaultPlan plan;
    plan.fault = kFaults[pick(kFaults.size())];
    plan.victim = kVictims[pick(kVictims.size())];
    plan.wire = kWires[pick(kWires.size())];
    plan.modality = kModalities[pick(kModalities.size())];
    plan.begin = from_seconds(2.5 * stream.uniform());
    plan.length = from_seconds(0.02 + 2 * stream.uniform());
    return plan;
}

// A link that is well until the fault begins.
class BadLink final : public Tap {
  public:
    BadLink(Channel& inner, const FaultPlan& plan, const SessionTime& now, const bool& on)
        : Tap(inner), plan_(&plan), now_(&now), on_(&on) {}
    void send(Bytes datagram) override {
        if (!*on_) return Tap::send(datagram);
        if (plan_->fault == Fault::kCut) return;
        if (plan_->fault == Fault::kDeaf) {
            if (++count_ % 10 == 0) Tap::send(datagram);
        } else if (plan_->fault == Fault::kClock) {
            send_an_hour_later(datagram);
        } else {
            kept_.push_back({{datagram.begin(), datagram.end()}, *now_});
            pass_on();
        }
    }

  private:
    struct Kept {
        std::vector<std::uint8_t> bytes;
        SessionTime since;
    };
    void send_an_hour_later(Bytes datagram) {
        Decoded decoded = decode(datagram);
        if (!decoded.message) return;
        decoded.message->header.send_time += std::chrono::hours{1};
        Tap::send(encoder_.encode(*decoded.message));
    }
    // Late: all with the same delay, when the next one comes. Shuffled: of each four the newest first.
    void pass_on() {
        if (plan_->fault == Fault::kLate) {
            while (!kept_.empty() && *now_ - kept_.front().since >= plan_->length) {
                give(kept_.front());
                kept_.pop_front();
            }
        } else if (kept_.size() == 4) {
            for (auto one = kept_.rbegin(); one != kept_.rend(); ++one) give(*one);
            kept_.clear();
        }
    }
    void give(const Kept& kept) {
        alignas(16) std::array<std::uint8_t, kMaxDatagramBytes> aligned{};
        std::copy(kept.bytes.begin(), kept.bytes.end(), aligned.begin());
        Tap::send({aligned.data(), kept.bytes.size()});
    }

    const FaultPlan* plan_;
    const SessionTime* now_;
    const bool* on_;
    unsigned count_ = 0;
    std::deque<Kept> kept_;
    Encoder encoder_;
};

bool program_fails(const FaultPlan& plan) {
    return plan.fault == Fault::kKill || plan.fault == Fault::kStandStill;
}

// Nothing new reaches the handle any more: by what the master still knows its force must be gone.
bool cuts_force(const FaultPlan& plan) {
    if (plan.fault == Fault::kKill) return plan.victim == Role::kSlaveSim || plan.victim == Role::kNetem;
    return plan.fault == Fault::kCut && (plan.wire == Wire::kForceMaster || plan.wire == Wire::kNeedle);
}
bool cuts_finger(const FaultPlan& plan) {
    if (plan.fault == Fault::kKill) return plan.victim == Role::kSlaveSim || plan.victim == Role::kNetem;
    return plan.fault == Fault::kCut && (plan.wire == Wire::kForceCutaneous || plan.wire == Wire::kNeedle);
}

class FaultTrial {
  public:
    explicit FaultTrial(const FaultPlan& plan) : plan_(plan), settings_(paper()), rig_(settings_, taps()) {}

    void run() {
        TrialConditions conditions = trial_of(plan_.modality);
        rig_.start(conditions);
        while (!rig_.session().finished() && !orphaned() && step()) {
        }
        check_end();
        if (program_fails(plan_) && plan_.fault == Fault::kKill) return;
        second_trial(conditions);
    }

  private:
    MakeTap taps() {
        return [this](Wire wire, Channel& end) -> std::unique_ptr<Tap> {
            if (program_fails(plan_) || wire != plan_.wire) return nullptr;
            return std::make_unique<BadLink>(end, plan_, now_, on_);
        };
    }

    // One instant, faults at their time, and what must hold at every one.
    bool step() {
        const SessionTime begin{plan_.begin};
        if (rig_.now() > SessionTime{seconds{90}}) {
            ADD_FAILURE() << "the trial does not end";
            return false;
        }
        if (!rig_.step()) return false;
        now_ = rig_.now();
        if (!began_ && now_ >= begin) {
            began_ = on_ = true;
            if (program_fails(plan_)) rig_.freeze(plan_.victim);
        }
        if (began_ && !thawed_ && plan_.fault == Fault::kStandStill && now_ >= begin + plan_.length) {
            thawed_ = true;
            rig_.thaw(plan_.victim);
        }
        return check_forces(now_ - begin);
    }

    // Nobody is left who could end the trial: the nodes give it up by themselves.
    bool orphaned() const {
        return began_ && plan_.fault == Fault::kKill && plan_.victim == Role::kSession &&
               rig_.now() > SessionTime{plan_.begin} + seconds{1};
    }

    bool check_forces(Duration since) {
        const double handle_N = rig_.force_at_handle_N();
        const double finger_N = rig_.force_at_finger_N();
        EXPECT_LE(std::abs(handle_N), settings_.master.guard.force_limit_N);
        EXPECT_LE(finger_N, settings_.cutaneous.force_limit_N);
        const StalePolicy& stale = settings_.master.stale;
        if (cuts_force(plan_) && since > stale.after + stale.ramp + milliseconds{2}) {
            EXPECT_EQ(handle_N, 0);
        }
        const Duration slack =
            settings_.cutaneous.stale.after + settings_.cutaneous.dead_time + milliseconds{2};
        if (cuts_finger(plan_) && since > slack) {
            EXPECT_EQ(finger_N, 0);
        }
        return !testing::Test::HasFailure();
    }

    void check_end() {
        if (plan_.victim == Role::kSession && plan_.fault == Fault::kKill && began_) {
            for (const NodeProcess* node : std::initializer_list<const NodeProcess*>{
                     &rig_.master(), &rig_.slave(), &rig_.cutaneous(), &rig_.visual(), &rig_.netem()})
                EXPECT_NE(node->state(), NodeState::kRunning) << "nobody steers: " << to_string(node->role());
        } else {
            EXPECT_TRUE(rig_.session().finished());
            EXPECT_NE(rig_.session().record().reason, EndReason::kNone);
        }
        const bool master_stands = program_fails(plan_) && plan_.victim == Role::kMaster && !thawed_;
        if (!master_stands) {
            EXPECT_EQ(rig_.force_at_handle_N(), 0) << "after the trial";
        }
    }

    // What failed works again: nothing of the trial before is left over.
    void second_trial(TrialConditions conditions) {
        on_ = on_ && plan_.fault == Fault::kClock;  // it has stepped, and does not fall back
        if (began_ && !thawed_ && plan_.fault == Fault::kStandStill) rig_.thaw(plan_.victim);
        rig_.idle(seconds{2});
        conditions.trial = 2;
        rig_.start(conditions);
        rig_.run_until(rig_.now() + milliseconds{600});
        EXPECT_TRUE(rig_.session().running())
            << "the next trial runs: " << to_string(rig_.session().record().reason);
    }

    FaultPlan plan_;
    SystemSettings settings_;
    SessionTime now_{};
    bool on_ = false, began_ = false, thawed_ = false;
    Rig rig_;
};

TEST(Faults, AtRandomInstantsOfManyTrials) {
    const char* wanted = std::getenv("THIMBLE_FAULT_TRIALS");
    const auto trials = static_cast<std::uint32_t>(wanted == nullptr ? 60 : std::atoi(wanted));
    for (std::uint32_t number = 1; number <= trials; ++number) {
        const FaultPlan plan = draw_plan(number);
        SCOPED_TRACE(std::string("trial ") + std::to_string(number) + ": " +
                     kFaultNames[static_cast<std::size_t>(plan.fault)] + ", " + to_string(plan.victim) +
                     ", wire " + std::to_string(static_cast<int>(plan.wire)) + ", " +
                     to_string(plan.modality) + " at " + std::to_string(to_seconds(plan.begin)) + " s for " +
                     std::to_string(to_seconds(plan.length)));
        FaultTrial(plan).run();
        if (HasFailure()) return;
    }
}

// A program that comes up again knows nothing of the trial that runs, and takes part from the next one on.
TEST(Faults, ARestartedMasterNeverActsInMidTrial) {
    Rig rig(paper());
    TrialConditions conditions = trial_of(Modality::kHF);
    rig.start(conditions);
    ASSERT_TRUE(rig.run_until_sample([](const TrajectorySample& s) { return s.contact_time_s >= 1; }));
    rig.freeze(Role::kMaster);
    rig.run_until(rig.now() + milliseconds{100});
    rig.restart_master();
    const SessionTime restarted = rig.now();
    while (rig.step()) ASSERT_NE(rig.master().state(), NodeState::kRunning);
    EXPECT_LT(rig.now() - restarted, seconds{1});
    EXPECT_EQ(rig.session().record().reason, EndReason::kPeerLost);
    EXPECT_EQ(rig.session().record().lost_peer, Role::kMaster);
    rig.idle(seconds{1});
    conditions.trial = 2;
    EXPECT_EQ(rig.run(conditions).reason, EndReason::kCompleted);
}

}  // namespace
}  // namespace thimble::test
