// Asks the programs of a session which stops they hold, for a program outside the session (stop_bus.hpp). Answers
// carry the age of each stop. So stops pressed after the inquiry began are separate from older ones, also with
// replayed messages and slow networks. No clock: `now` is the caller's.
#pragma once

#include <algorithm>
#include <cstdint>
#include <variant>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "common/stop_bus.hpp"

namespace thimble {

struct LatchedStop {
    Role by = Role::kSession;
    StopOrder stop;
    bool since_before = false;  // held for kHeldAtLeast, and from before the first call
};

class StopInquiry {
  public:
    // `at`: the stop buses of the programs, from which the answers come. `out` sends there. Both outlive this.
    // `number`: of the questions, or of the stop that is answered. Never used before: an answer to another one is old.
    StopInquiry(OutboundFlow& out, const StopOutlets& at, std::uint64_t number)
        : out_(&out), at_(at), number_(number) {
        held_.reserve(kMostAnswers);
    }

    void ask(SessionTime now) {
        if (begun_ == kNever) begun_ = now;
        out_->send(now, 0, StopOrder(number_, StopKind::kAsk, EndReason::kEmergencyStop, {}));
    }

    // Takes the answers to this number that have come.
    void hear(SessionTime now) {
        if (begun_ == kNever) begun_ = now;
        for (Channel* channel : at_) hear(now, *channel);
    }

    // One entry per stop and program.
    const std::vector<LatchedStop>& held() const { return held_; }

  private:
    static constexpr std::size_t kMostAnswers = 192;  // what six programs can hold
    void hear(SessionTime now, Channel& channel) {
        for (int taken = 0; taken < kMostRefusedAtOnce; ++taken) {
            const Bytes in = channel.receive();
            if (in.empty()) return;
            if (decode_into(in, message_)) continue;
            const auto* order = std::get_if<StopOrder>(&message_.body);
            if (order == nullptr || order->kind != StopKind::kStop) continue;
            if (message_.header.trial != number_in_answer(number_)) continue;
            // The age is that at the answer, which was sent before now.
            const Duration held = std::chrono::milliseconds{order->held_ms};
            note({message_.header.sender, *order, held >= std::max<Duration>(kHeldAtLeast, now - begun_)});
        }
    }

    void note(const LatchedStop& answer) {
        const auto known = std::find_if(held_.begin(), held_.end(), [&answer](const LatchedStop& other) {
            return other.by == answer.by && other.stop.id == answer.stop.id;
        });
        if (known != held_.end()) {
            known->since_before = known->since_before || answer.since_before;
        } else if (held_.size() < kMostAnswers) {
            held_.push_back(answer);
        }
    }

    OutboundFlow* out_;
    StopOutlets at_;
    std::uint64_t number_;
    SessionTime begun_ = kNever;  // the first call
    std::vector<LatchedStop> held_;
    Message message_;
};

// Releases the stops of a session from outside it: asks every program which stops it holds (stop_inquiry.hpp),
// and names it (stop_bus.hpp). A stop that is pressed while the release is under way holds. No clock: `now` is the caller's.

class StopRelease : boost::noncopyable {
  public:
    // Asked for kAskTimes rounds, and in later ones until a stop is named. A stop that is heard in the last of the kAskTimes is still
    // released kReleaseTimes times.
    static constexpr int kAskTimes = 4, kRounds = kAskTimes + kReleaseTimes;

    // `instance`: random per start. `at`: as StopInquiry has it.
    StopRelease(std::uint64_t instance, const StopOutlets& at)
        : out_(Role::kExperimenter, instance, {at[0], at[1], at[2], at[3], at[4], at[5]}),
          inquiry_(out_, at, instance) {}

    // At least kRounds of them, every kStopRepeat.
    void round(SessionTime now) {
        inquiry_.hear(now);
        if (rounds_++ < kAskTimes || stops_.empty()) inquiry_.ask(now);
        for (const LatchedStop& held : inquiry_.held()) {
            const bool known = std::any_of(stops_.begin(), stops_.end(), [&held](const StopOrder& other) {
                return other.id == held.stop.id;
            });
            if (held.since_before && !known) stops_.push_back(held.stop);
        }
        for (const StopOrder& stop : stops_)
            out_.send(now, 0, StopOrder(stop.id, StopKind::kRelease, EndReason::kEmergencyStop, {}));
    }

    // The stops named so far, each once.
    const std::vector<StopOrder>& stops() const { return stops_; }

  private:
    OutboundFlow out_;
    StopInquiry inquiry_;
    int rounds_ = 0;
    std::vector<StopOrder> stops_;
};

}  // namespace thimble
