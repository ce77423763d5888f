#include "session/play/order_lines.hpp"

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
            lines_.emplace_back("r asked for at the experimenter's view");
            return std::nullopt;
        case OrderKind::kExclude:
            lines_.emplace_back("x asked for at the experimenter's view");
            return std::nullopt;
        case OrderKind::kQuit:
            if (lines_.empty() || lines_.back() != "q") lines_.emplace_back("q");
            return std::nullopt;
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

std::optional<Refusal> QuitHandler::obey(SessionTime /*now*/, const Order& order) {
    if (order.kind != OrderKind::kQuit) return Refusal::kUnexpectedKind;
    quit_ = true;
    return std::nullopt;
}

}  // namespace thimble
