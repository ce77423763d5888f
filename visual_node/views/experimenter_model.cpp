#include "visual_node/views/experimenter_model.hpp"

namespace thimble {

void ExperimenterModel::update(SessionTime now) {
    link_.update(now);
    if (!choosing_ && link_.receiver().heard()) chosen_ = link_.monitor().modality;
}

void ExperimenterModel::answer(SessionTime now, bool yes) {
    if (yes && question_) {
        Order order;
        order.kind = OrderKind::kExclude;
        order.trial = *question_;  // the trial shown may be the next one by now
        link_.ask(now, order);
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
    if (link_.take(now, command)) return;
    switch (command) {
        case Command::kStart:
            return link_.ask(now, OrderKind::kStart, chosen_);
        case Command::kRepeat:
            if (trial == 0) return;
            unseen_ = OrderKind::kRepeat;
            return link_.ask(now, OrderKind::kRepeat);
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
