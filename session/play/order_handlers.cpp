#include "session/play/order_handlers.hpp"

namespace thimble {

std::optional<Refusal> OrderLines::obey(SessionTime /*now*/, const Order& order) {
    switch (order.kind) {
        case OrderKind::kPause:
            context_.paused = true;
            go_on_ = false;
            return std::nullopt;
        case OrderKind::kStart:
        case OrderKind::kResume:
            context_.paused = false;
            go_on();
            return std::nullopt;
        case OrderKind::kRepeat:
            lines_.emplace_back("r requested in the experimenter's view");
            return std::nullopt;
        case OrderKind::kExclude:
            lines_.emplace_back("x requested in the experimenter's view");
            return std::nullopt;
        case OrderKind::kQuit:
            if (lines_.empty() || lines_.back() != "q") lines_.emplace_back("q");
            return std::nullopt;
        default:
            return Refusal::kUnexpectedKind;
    }
}

// Ignored while a trial runs: it would answer the next question before it is asked.
void OrderLines::go_on() { go_on_ = session_ == nullptr || !session_->running(); }

std::optional<std::string> OrderLines::take_line() {
    if (!lines_.empty()) {
        std::string line = lines_.front();
        lines_.pop_front();
        return line;
    }
    if (!go_on_) return std::nullopt;
    go_on_ = false;
    return std::string();
}

std::optional<Refusal> QuitHandler::obey(SessionTime /*now*/, const Order& order) {
    if (order.kind != OrderKind::kQuit) return Refusal::kUnexpectedKind;
    quit_ = true;
    return std::nullopt;
}

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
            context_.paused = false;  // Start also ends a pause
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
        default:
            return Refusal::kUnexpectedKind;  // of participant sessions and of replays
    }
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
