#include "session/play/order_taker.hpp"

#include <variant>

namespace thimble {

void OrderTaker::tick(SessionTime now, std::uint32_t trial) {
    while (const Message* message = flow_.receive(now, *in_)) {
        const auto* order = std::get_if<Order>(&message->body);
        const std::optional<Refusal> refusal = order == nullptr
                                                   ? std::optional{Refusal::kUnexpectedKind}
                                                   : judge(now, message->header.trial, trial, *order);
        if (refusal) flow_.refuse_admitted(*refusal);
    }
}

std::optional<Refusal> OrderTaker::judge(SessionTime now, std::uint32_t asked_for, std::uint32_t trial,
                                         const Order& order) {
    switch (order.kind) {
        case OrderKind::kStart:
        case OrderKind::kEndTrial:
            if (asked_for != trial) return Refusal::kWrongTrial;
            break;
        case OrderKind::kRepeat:
        case OrderKind::kExclude:
            // Only the newest trial can be judged, as by what is typed.
            if (order.trial != trial) return Refusal::kWrongTrial;
            if (said_again(now, order.kind == OrderKind::kRepeat ? repeat_ : exclude_, trial))
                return std::nullopt;
            break;
        case OrderKind::kDelay:
        case OrderKind::kNetwork:
        case OrderKind::kPause:
        case OrderKind::kResume:
        case OrderKind::kQuit:
        case OrderKind::kSeek:
        case OrderKind::kSpeed:
            break;
    }
    return handler_->obey(now, order);
}

bool OrderTaker::said_again(SessionTime now, Request& request, std::uint32_t trial) {
    const bool again = request.said && request.trial == trial && now - request.last <= kSameRequest;
    request = {trial, now, true};
    return again;
}

}  // namespace thimble
