#include "session/play/order_lines.hpp"

namespace thimble {

Refusal OrderLines::obey(SessionTime /*now*/, const Order& order) {
    switch (order.kind) {
        case OrderKind::kPause:
            context_.paused = true;
            go_on_ = false;
            return Refusal::kCount;
        case OrderKind::kStart:
        case OrderKind::kResume:
            context_.paused = false;
            go_on();
            return Refusal::kCount;
        case OrderKind::kRepeat:
            lines_.emplace_back("r asked for at the experimenter's view");
            return Refusal::kCount;
        case OrderKind::kExclude:
            lines_.emplace_back("x asked for at the experimenter's view");
            return Refusal::kCount;
        case OrderKind::kQuit:
            if (lines_.empty() || lines_.back() != "q") lines_.emplace_back("q");
            return Refusal::kCount;
        case OrderKind::kDelay:
        case OrderKind::kNetwork:
        case OrderKind::kEndTrial:
        case OrderKind::kSeek:
        case OrderKind::kSpeed:
            return Refusal::kUnexpectedKind;
    }
    return Refusal::kUnexpectedKind;
}

// Not while a trial runs: it would answer the next question before it is asked.
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

Refusal QuitDesk::obey(SessionTime /*now*/, const Order& order) {
    if (order.kind != OrderKind::kQuit) return Refusal::kUnexpectedKind;
    quit_ = true;
    return Refusal::kCount;
}

}  // namespace thimble
