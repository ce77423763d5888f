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

const char* PlayerModel::hint(SessionTime now) const {
    if (replaying()) return "A recorded trial. Drag the bar, or press Space.";
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
