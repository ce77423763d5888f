#include "visual_node/views/player_model.hpp"

namespace thimble {
namespace {

// From about here HF with a pointer for a handle swings by millimetres (docs/play.md).
constexpr double kNoticeableDelay_s = 0.02;

}  // namespace

Modality PlayerModel::modality() const {
    const bool asking = link_.orders().progress(OrderKind::kStart) == OrderProgress::kAsking;
    return asking ? link_.orders().asked(OrderKind::kStart).modality : link_.monitor().modality;
}

void PlayerModel::ask(SessionTime now, OrderKind kind, Modality modality) {
    Order order;
    order.kind = kind;
    order.modality = modality;
    order.trial = link_.receiver().trial();
    link_.ask(now, order);
}

void PlayerModel::press(SessionTime now, Command command) {
    if (const auto modality = modality_of(command)) return start(now, *modality);
    if (const auto delay_s = preset_of_s(command)) return set_delay(now, *delay_s);
    switch (command) {
        case Command::kDelayDown:
            return set_delay(now, link_.delay_s() - kDelayStep_s);
        case Command::kDelayUp:
            return set_delay(now, link_.delay_s() + kDelayStep_s);
        case Command::kStart:
            return start(now, modality());
        case Command::kPause:
            return ask(now, link_.monitor().paused ? OrderKind::kResume : OrderKind::kPause, modality());
        case Command::kEndTrial:
            return ask(now, OrderKind::kEndTrial, modality());
        case Command::kHelp:
            help_ = !help_;
            return;
        default:
            return;
    }
}

const char* PlayerModel::hint(SessionTime now) const {
    const Monitor& monitor = link_.monitor();
    if (!link_.running(now)) return "Choose a modality, or press Space, to start.";
    if (monitor.needle_held) return "The needle is held: no commands arrive at the tissue.";
    if (monitor.beeped) return "That was the beep: pull the needle out, then press Space for another go.";
    const bool at_fixture =
        monitor.fixture_present && monitor.position_needle_m >= monitor.position_fixture_m;
    if (at_fixture && monitor.modality == Modality::kHF && link_.delay_s() >= kNoticeableDelay_s) {
        return "At the fixture, with a late force: does it shake? Now take the delay away.";
    }
    if (at_fixture) return "At the fixture: stay there until the beep.";
    if (monitor.phase == TissuePhase::kPenetrated) return "Inside. Go on until something stops you.";
    if (monitor.phase == TissuePhase::kContact) return "Press on: the tissue gives way and then breaks.";
    return "Move the needle into the tissue.";
}

}  // namespace thimble
