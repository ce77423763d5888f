// Programs that die or stand still, links that are cut, late, shuffled or almost deaf, clocks that jump, at random instants of
// many trials: no force above its limit, none that was not sent or is beyond its time, no trial that never ends, and the next one runs.
// How many: THIMBLE_FAULT_TRIALS (docs/reliability.md).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <string>
#include <variant>
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
constexpr std::array kWires{Wire::kOrders,         Wire::kHeartbeats,  Wire::kNeedle, Wire::kForceMaster,
                            Wire::kForceCutaneous, Wire::kForceVisual, Wire::kRecord, Wire::kPerceptCutaneous,
                            Wire::kPerceptVisual,  Wire::kScene};

struct FaultPlan {
    Fault fault = Fault::kKill;
    Role victim = Role::kMaster;
    Wire wire = Wire::kNeedle;
    Modality modality = Modality::kHF;
    Duration begin{};
    Duration length{};        // of kStandStill and kLate
    bool clock_back = false;  // kClock: an hour back instead of ahead
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
    plan.begin = from_seconds(8 * stream.uniform());  // the needle touches at 2.3 s, and ends at 13
    plan.length = from_seconds(0.02 + 2 * stream.uniform());
    plan.clock_back = stream.uniform() < 0.5;
    return plan;
}

// The forces that came to the handle, newest last: messages that a flow takes, with a sequence higher than all before.
struct Arrived {
    static constexpr std::size_t kKept = 8;
    std::deque<double> forces_N;  // as the master would give them to the handle
    SessionTime newest_at{};
    std::uint32_t newest = 0;
    double scale = 1;

    void hear(Bytes datagram, SessionTime now) {
        const Decoded decoded = decode(datagram);
        const auto* force = decoded.message ? std::get_if<ForceFeedback>(&decoded.message->body) : nullptr;
        if (force == nullptr || decoded.message->header.sequence <= newest) return;
        newest = decoded.message->header.sequence;
        newest_at = now;
        forces_N.push_back(-scale * force->force_total_N);
        if (forces_N.size() > kKept) forces_N.pop_front();
    }
};

// A link that is well until the fault begins. At the master's end it writes down the forces that come.
class BadLink final : public Tap {
  public:
    BadLink(Channel& inner, const FaultPlan& plan, const SessionTime& now, const bool& on, Arrived* arrived)
        : Tap(inner), plan_(&plan), now_(&now), on_(&on), arrived_(arrived) {}
    void send(Bytes datagram) override {
        if (!*on_) return pass(datagram);
        if (plan_->fault == Fault::kCut) return;
        if (plan_->fault == Fault::kDeaf) {
            if (++count_ % 10 == 0) pass(datagram);
        } else if (plan_->fault == Fault::kClock) {
            send_an_hour_off(datagram);
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
    void pass(Bytes datagram) {
        if (arrived_ != nullptr) arrived_->hear(datagram, *now_);
        Tap::send(datagram);
    }
    void send_an_hour_off(Bytes datagram) {
        Decoded decoded = decode(datagram);
        if (!decoded.message) return;
        const std::chrono::hours step{plan_->clock_back ? -1 : 1};
        decoded.message->header.send_time += step;
        pass(encoder_.encode(*decoded.message));
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
        pass({aligned.data(), kept.bytes.size()});
    }

    const FaultPlan* plan_;
    const SessionTime* now_;
    const bool* on_;
    Arrived* arrived_;  // null: no one listens
    unsigned count_ = 0;
    std::deque<Kept> kept_;
    Encoder encoder_;
};

bool program_fails(const FaultPlan& plan) {
    return plan.fault == Fault::kKill || plan.fault == Fault::kStandStill;
}

// A wire on which nothing that is accepted passes from the beginning of the fault until its end.
bool silences(const FaultPlan& plan, Wire wire) {
    if (program_fails(plan)) return plan.victim == Role::kSlaveSim || plan.victim == Role::kNetem;
    if (plan.wire != wire) return false;
    // A stamp that goes back is refused as one of the past.
    return plan.fault == Fault::kCut || plan.fault == Fault::kLate ||
           (plan.fault == Fault::kClock && plan.clock_back);
}
bool ends_by_itself(const FaultPlan& plan) {
    return plan.fault == Fault::kStandStill || plan.fault == Fault::kLate;
}

// Nothing new reaches the handle any more: by what the master still knows its force must be gone.
bool cuts_force(const FaultPlan& plan) {
    return silences(plan, Wire::kForceMaster) || silences(plan, Wire::kNeedle);
}
bool cuts_finger(const FaultPlan& plan) {
    return silences(plan, Wire::kForceCutaneous) || silences(plan, Wire::kNeedle);
}

// Less than the silence that ends a trial, on a wire of data: it goes on to its own end. (Orders and heartbeats come so rarely that
// nine of ten lost are silence.)
bool is_survived(const FaultPlan& plan) {
    constexpr Duration kShort = kPeerTimeout - milliseconds{150};
    const bool data = plan.wire != Wire::kOrders && plan.wire != Wire::kHeartbeats;
    if (ends_by_itself(plan)) return plan.length < kShort && (data || program_fails(plan));
    return data && (plan.fault == Fault::kDeaf || plan.fault == Fault::kShuffled);
}

class FaultTrial {
  public:
    explicit FaultTrial(const FaultPlan& plan) : plan_(plan), settings_(paper()), rig_(settings_, taps()) {
        arrived_.scale = settings_.master.force_scale;
    }

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
            const bool bad = !program_fails(plan_) && wire == plan_.wire;
            Arrived* const listens = wire == Wire::kForceMaster ? &arrived_ : nullptr;
            if (!bad && listens == nullptr) return nullptr;
            return std::make_unique<BadLink>(end, plan_, now_, bad ? on_ : never_, listens);
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

    // Without a session the nodes give the trial up by themselves.
    bool orphaned() const {
        return began_ && plan_.fault == Fault::kKill && plan_.victim == Role::kSession &&
               rig_.now() > SessionTime{plan_.begin} + seconds{1};
    }

    bool check_forces(Duration since) {
        const double handle_N = rig_.force_at_handle_N();
        const double finger_N = rig_.force_at_finger_N();
        EXPECT_LE(std::abs(handle_N), settings_.master.guard.force_limit_N);
        EXPECT_LE(finger_N, settings_.cutaneous.force_limit_N);
        if (!master_stands()) check_force_of_handle(handle_N);
        if (plan_.modality == Modality::kHF || plan_.modality == Modality::kVF) {
            EXPECT_EQ(finger_N, 0) << "of fingers in another modality";
        }
        const bool over = ends_by_itself(plan_) && since > plan_.length;
        const StalePolicy& stale = settings_.master.stale;
        if (cuts_force(plan_) && !over && since > stale.after + stale.ramp + milliseconds{2}) {
            EXPECT_EQ(handle_N, 0);
        }
        const Duration slack =
            settings_.cutaneous.stale.after + settings_.cutaneous.dead_time + milliseconds{2};
        if (cuts_finger(plan_) && !over && since > slack) {
            EXPECT_EQ(finger_N, 0);
        }
        return !testing::Test::HasFailure();
    }

    bool master_stands() const {
        return program_fails(plan_) && plan_.victim == Role::kMaster && began_ && !thawed_;
    }

    // With any fault: no force, or one of the last that came, or after a silence a part of the last one.
    void check_force_of_handle(double handle_N) {
        if (handle_N == 0) return;
        EXPECT_EQ(plan_.modality, Modality::kHF) << "a handle that pushes in another modality";
        const double limit_N = settings_.master.force_limit_N;
        const auto given = [&](double force_N) { return std::clamp(force_N, -limit_N, limit_N); };
        const bool came = std::any_of(arrived_.forces_N.begin(), arrived_.forces_N.end(),
                                      [&](double force_N) { return handle_N == given(force_N); });
        const StalePolicy& stale = settings_.master.stale;
        const Duration silence = now_ - arrived_.newest_at;
        EXPECT_LE(silence, stale.after + stale.ramp + milliseconds{2}) << handle_N << " N beyond its time";
        if (silence < stale.after) {
            EXPECT_TRUE(came) << handle_N << " N at the handle, which nobody sent";
        } else {
            const double last_N = arrived_.forces_N.empty() ? 0 : given(arrived_.forces_N.back());
            EXPECT_TRUE(came || (handle_N * last_N > 0 && std::abs(handle_N) <= std::abs(last_N)));
        }
    }

    void check_end() {
        if (plan_.victim == Role::kSession && plan_.fault == Fault::kKill && began_) {
            for (const NodeProcess* node : rig_.nodes())
                EXPECT_NE(node->state(), NodeState::kRunning) << "nobody steers: " << to_string(node->role());
        } else {
            EXPECT_TRUE(rig_.session().finished());
            const EndReason reason = rig_.session().record().reason;
            EXPECT_NE(reason, EndReason::kNone);
            if (is_survived(plan_)) {
                EXPECT_TRUE(reason == EndReason::kCompleted || reason == EndReason::kTimeout)
                    << to_string(reason);
            }
        }
        // The simulated handle gives no force without its program; what a real one does then stands in docs/reliability.md.
        if (!master_stands()) {
            EXPECT_EQ(rig_.force_at_handle_N(), 0) << "after the trial";
        }
    }

    // The failed part works again, and nothing of the trial before is left over.
    void second_trial(TrialConditions conditions) {
        // It has stepped ahead, and does not fall back. One that has stepped back is refused for as long.
        on_ = on_ && plan_.fault == Fault::kClock && !plan_.clock_back;
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
    const bool never_ = false;
    Arrived arrived_;
    Rig rig_;
};

std::string words_of(const FaultPlan& plan) {
    return std::string(kFaultNames[static_cast<std::size_t>(plan.fault)]) +
           (plan.fault == Fault::kClock && plan.clock_back ? " back, " : ", ") + to_string(plan.victim) +
           ", wire " + std::to_string(static_cast<int>(plan.wire)) + ", " + to_string(plan.modality) +
           " at " + std::to_string(to_seconds(plan.begin)) + " s for " +
           std::to_string(to_seconds(plan.length));
}

TEST(Faults, AtRandomInstantsOfManyTrials) {
    const char* wanted = std::getenv("THIMBLE_FAULT_TRIALS");
    const auto trials = static_cast<std::uint32_t>(wanted == nullptr ? 60 : std::atoi(wanted));
    for (std::uint32_t number = 1; number <= trials; ++number) {
        const FaultPlan plan = draw_plan(number);
        SCOPED_TRACE("trial " + std::to_string(number) + ": " + words_of(plan));
        FaultTrial(plan).run();
        if (HasFailure()) return;
    }
}

TEST(Faults, ClocksThatStepEitherWayOnEachWire) {
    for (const Wire wire : kWires) {
        for (const bool back : {false, true}) {
            FaultPlan plan;
            plan.fault = Fault::kClock;
            plan.wire = wire;
            plan.modality = wire == Wire::kForceCutaneous || wire == Wire::kPerceptCutaneous ? Modality::kCF
                                                                                             : Modality::kHF;
            plan.begin = seconds{5};  // the needle presses
            plan.clock_back = back;
            SCOPED_TRACE(words_of(plan));
            FaultTrial(plan).run();
            if (HasFailure()) return;
        }
    }
}

// A program that was started anew does not know the running trial. It takes part from the next one on.
TEST(Faults, ARestartedMasterNeverActsInMidTrial) {
    for (const Duration stood_still : {milliseconds{0}, milliseconds{100}}) {
        Rig rig(paper());
        TrialConditions conditions = trial_of(Modality::kHF);
        rig.start(conditions);
        ASSERT_TRUE(rig.run_until_contact(1));
        if (stood_still > Duration::zero()) rig.freeze(Role::kMaster);
        rig.run_until(rig.now() + stood_still);
        rig.restart_master();
        const SessionTime restarted = rig.now();
        while (rig.step()) ASSERT_NE(rig.master().state(), NodeState::kRunning);
        EXPECT_LT(rig.now() - restarted, seconds{1});
        EXPECT_EQ(rig.session().record().reason, EndReason::kPeerLost);
        EXPECT_EQ(rig.session().record().lost_peer, Role::kMaster);
        rig.idle(seconds{1});
        conditions.trial = 2;
        const TrialRecord& next = rig.run(conditions);
        EXPECT_EQ(next.reason, EndReason::kCompleted);
        EXPECT_FALSE(std::isnan(next.beep_time_s));
    }
}

}  // namespace
}  // namespace thimble::test
