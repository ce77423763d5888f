#include "visual_node/views/replay_model.hpp"

#include <algorithm>

namespace thimble {
namespace {

constexpr ReplayState kNoReplay{};

}  // namespace

const ReplayState& ReplayModel::state() const {
    const ReplayState* replay = link_->receiver().replay();
    return replay == nullptr ? kNoReplay : *replay;
}

double ReplayModel::position_s() const {
    return asking(OrderKind::kSeek) ? link_->orders().asked(OrderKind::kSeek).value : link_->monitor().time_s;
}

bool ReplayModel::paused() const {
    if (asking(OrderKind::kPause)) return true;
    return !asking(OrderKind::kResume) && link_->monitor().paused;
}

double ReplayModel::speed() const {
    return asking(OrderKind::kSpeed) ? link_->orders().asked(OrderKind::kSpeed).value : state().speed;
}

void ReplayModel::seek(SessionTime now, double time_s) {
    link_->ask(now, OrderKind::kSeek, Modality::kHF, std::clamp(time_s, 0.0, state().duration_s));
}

// At its end a replay stands still as well: there, the key shows the trial once more.
void ReplayModel::play_or_pause(SessionTime now) {
    const bool at_end = position_s() >= state().duration_s;
    if (at_end) seek(now, 0);
    if (paused()) {
        link_->ask(now, OrderKind::kResume);
    } else if (!at_end) {
        link_->ask(now, OrderKind::kPause);
    }
}

void ReplayModel::stop_and_step(SessionTime now, double step_s) {
    const double from_s = position_s();
    if (!paused()) link_->ask(now, OrderKind::kPause);
    seek(now, from_s + step_s);
}

void ReplayModel::press(SessionTime now, Command command) {
    if (const auto speed = speed_of(command)) {
        return link_->ask(now, OrderKind::kSpeed, Modality::kHF, *speed);
    }
    switch (command) {
        case Command::kPlayPause:
            return play_or_pause(now);
        case Command::kFrameBack:
            return stop_and_step(now, -kReplayFrame_s);
        case Command::kFrameOn:
            return stop_and_step(now, kReplayFrame_s);
        case Command::kBack:
            return seek(now, position_s() - kReplayStep_s);
        case Command::kOn:
            return seek(now, position_s() + kReplayStep_s);
        case Command::kFarBack:
            return seek(now, position_s() - kReplayFarStep_s);
        case Command::kFarOn:
            return seek(now, position_s() + kReplayFarStep_s);
        case Command::kToBegin:
            return seek(now, 0);
        case Command::kToEnd:
            return seek(now, state().duration_s);
        default:
            return;
    }
}

double ScrubScale::x(double time_s) const {
    if (!(duration_s > 0)) return bar.x;
    return bar.x + std::clamp(time_s / duration_s, 0.0, 1.0) * bar.width;
}

double ScrubScale::time_s(double x) const {
    if (!(bar.width > 0)) return 0;
    return std::clamp((x - bar.x) / bar.width, 0.0, 1.0) * duration_s;
}

}  // namespace thimble
