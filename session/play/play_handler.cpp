#include "session/play/play_handler.hpp"

namespace thimble {

std::optional<Refusal> PlayHandler::obey(SessionTime now, const Order& order) {
    switch (order.kind) {
        case OrderKind::kDelay:
            if (order.value > kLongestDelay_s) return Refusal::kOutOfRange;
            if (session_ != nullptr) session_->change_delay(from_seconds(order.value));
            return std::nullopt;
        case OrderKind::kNetwork:
            if (session_ != nullptr && !session_->change_network(order.network)) return Refusal::kOutOfRange;
            return std::nullopt;
        case OrderKind::kStart:
            next_ = order.modality;
            not_before_ = now;
            context_.paused = false;  // who says Start wants one
            end_running();
            return std::nullopt;
        case OrderKind::kEndTrial:
            next_.reset();
            end_running();
            return std::nullopt;
        case OrderKind::kPause:
        case OrderKind::kResume:
            context_.paused = order.kind == OrderKind::kPause;
            return std::nullopt;
        case OrderKind::kQuit:
            quit_ = true;
            end_running();
            return std::nullopt;
        case OrderKind::kRepeat:
        case OrderKind::kExclude:
        case OrderKind::kSeek:
        case OrderKind::kSpeed:
            return Refusal::kUnexpectedKind;  // of participant sessions and of replays
    }
    return Refusal::kUnexpectedKind;
}

void PlayHandler::end_running() {
    if (session_ != nullptr) session_->abort(EndReason::kInterrupted);
}

std::optional<Modality> PlayHandler::take_due(SessionTime now) {
    if (!next_ || quit_ || context_.paused || now < not_before_) return std::nullopt;
    const auto due = next_;
    next_.reset();
    return due;
}

void PlayHandler::trial_ended(SessionTime now, const TrialRecord& record) {
    if (record.reason == EndReason::kInterrupted || is_stop(record.reason))
        return;  // the order also says what comes next
    next_ = record.conditions.modality;
    not_before_ = now + kBetweenTrials;
}

}  // namespace thimble
