#include "visual_node/views/experimenter_model.hpp"

namespace thimble {

void ExperimenterModel::update(SessionTime now) {
    link_.update(now);
    if (!choosing_ && link_.receiver().heard()) chosen_ = link_.monitor().modality;
}

void ExperimenterModel::ask(SessionTime now, OrderKind kind, std::uint32_t trial) {
    Order order;
    order.kind = kind;
    order.trial = trial;
    order.modality = chosen_;
    link_.ask(now, order);
}

void ExperimenterModel::answer(SessionTime now, bool yes) {
    if (yes && question_) {
        ask(now, OrderKind::kExclude, *question_);
        unseen_ = OrderKind::kExclude;
    }
    question_.reset();
}

void ExperimenterModel::press(SessionTime now, Command command) {
    const std::uint32_t trial = link_.receiver().trial();
    if (const auto modality = modality_of(command)) {
        chosen_ = *modality;
        choosing_ = true;
        return;
    }
    if (const auto delay_s = preset_of_s(command)) return set_delay(now, *delay_s);
    switch (command) {
        case Command::kDelayDown:
            return set_delay(now, link_.delay_s() - kDelayStep_s);
        case Command::kDelayUp:
            return set_delay(now, link_.delay_s() + kDelayStep_s);
        case Command::kStart:
            return ask(now, OrderKind::kStart, trial);
        case Command::kPause:
            return ask(now, link_.monitor().paused ? OrderKind::kResume : OrderKind::kPause, 0);
        case Command::kEndTrial:
            return ask(now, OrderKind::kEndTrial, trial);
        case Command::kRepeat:
            if (trial == 0) return;
            unseen_ = OrderKind::kRepeat;
            return ask(now, OrderKind::kRepeat, trial);
        case Command::kExclude:
            if (trial != 0) question_ = trial;
            return;
        case Command::kYes:
            return answer(now, true);
        case Command::kNo:
            return answer(now, false);
        case Command::kHelp:
            help_ = !help_;
            return;
        default:
            return;
    }
}

TextLine ExperimenterModel::notice() const {
    if (!unseen_) return {};
    const OrderSender& orders = link_.orders();
    const bool sent = orders.progress(*unseen_) == OrderProgress::kSent;
    return TextLine::of("{} of trial {}: {}", to_string(*unseen_), orders.asked(*unseen_).trial,
                        sent ? "sent, the session's log has the answer" : "being sent");
}

}  // namespace thimble
