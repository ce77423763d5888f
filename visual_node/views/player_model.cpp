#include "visual_node/views/player_model.hpp"

#include <algorithm>
#include <array>

namespace thimble {
namespace {

constexpr ReplayState kNoReplay{};

// From about here HF with a pointer for a handle swings by millimetres (docs/play.md).
constexpr double kNoticeableDelay_s = 0.02;

// Without words of its own, a keyboard or a device has those of the mouse.
struct Hint {
    const char* mouse = nullptr;
    const char* keyboard = nullptr;
    const char* device = nullptr;

    const char* of(HandKind kind) const {
        const char* const own = kind == HandKind::kKeyboard ? keyboard : device;
        return kind == HandKind::kMouse || own == nullptr ? mouse : own;
    }
};

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

Modality PlayerModel::modality() const {
    const bool asking = link_.orders().progress(OrderKind::kStart) == OrderProgress::kAsking;
    return asking ? link_.orders().asked(OrderKind::kStart).modality : link_.monitor().modality;
}

void PlayerModel::press(SessionTime now, Command command) {
    if (command == Command::kHelp) {
        help_ = !help_;
    } else if (replaying()) {
        replay_.press(now, command);
    } else if (const auto modality = modality_of(command)) {
        start(now, *modality);
    } else if (command == Command::kStart) {
        start(now, this->modality());
    } else {
        link_.take(now, command);
    }
}

PlayerStep PlayerModel::step(SessionTime now) const {
    const Monitor& monitor = link_.monitor();
    if (!link_.running(now)) return monitor.paused ? PlayerStep::kPaused : PlayerStep::kStart;
    if (monitor.needle_held) return PlayerStep::kNeedleHeld;
    if (hand_holds_ == false) return PlayerStep::kTake;
    if (monitor.beeped) return PlayerStep::kWithdraw;
    if (monitor.fixture_present && monitor.position_needle_m >= monitor.position_fixture_m) {
        const bool late = monitor.modality == Modality::kHF && link_.delay_s() >= kNoticeableDelay_s;
        return late ? PlayerStep::kShaking : PlayerStep::kStay;
    }
    if (monitor.phase == TissuePhase::kPenetrated) return PlayerStep::kInside;
    return monitor.phase == TissuePhase::kContact ? PlayerStep::kPress : PlayerStep::kApproach;
}

const char* PlayerModel::hint() const {
    static constexpr std::array kHints{
        Hint{"Choose on the right how to feel the force, or press Space."},
        Hint{"Paused. Press P to continue, or choose on the right how to feel the force."},
        Hint{"The needle is held: no commands reach the tissue."},
        Hint{"Click in this picture. Then move the mouse down, towards you.",
             "Hold the arrow key Down: it takes the needle and pushes it in."},
        Hint{"Move the mouse down: the needle goes to the skin. Esc releases the needle.",
             "Hold Down: the needle goes to the skin. Esc releases the needle.",
             "Push your device: the needle goes to the skin."},
        Hint{"Keep pushing: the skin gives way, and then it tears."},
        Hint{"The needle is inside. Push until something stops it."},
        Hint{"Something stops the needle. Stay there until the beep, and push no harder."},
        Hint{"The force comes late: does it shake? Now choose No delay on the right."},
        Hint{"That was the beep. Move the mouse up to pull the needle out.",
             "That was the beep. Hold Up to pull the needle out.",
             "That was the beep. Pull your device to draw the needle out."},
    };
    if (replaying()) return "A recorded trial. Drag the bar on the right, or press Space.";
    return kHints.at(static_cast<std::size_t>(step_.shown())).of(hand_kind_);
}

}  // namespace thimble
