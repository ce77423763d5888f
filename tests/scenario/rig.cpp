#include "tests/scenario/rig.hpp"

namespace thimble::test {
namespace {

// Null: a wire that no test has a name for.
std::optional<Wire> wire_to(Port port) {
    if (port <= Port::kSessionNetem) return Wire::kHeartbeats;
    if (port >= Port::kMasterControl && port <= Port::kNetemControl) return Wire::kOrders;
    constexpr std::array kNamed{std::pair{Port::kSlaveNeedle, Wire::kNeedle},
                                std::pair{Port::kMasterForce, Wire::kForceMaster},
                                std::pair{Port::kCutaneousForce, Wire::kForceCutaneous},
                                std::pair{Port::kVisualForce, Wire::kForceVisual},
                                std::pair{Port::kVisualBeep, Wire::kBeep},
                                std::pair{Port::kSessionRecord, Wire::kRecord},
                                std::pair{Port::kMasterPerceptCutaneous, Wire::kPerceptCutaneous},
                                std::pair{Port::kMasterPerceptVisual, Wire::kPerceptVisual}};
    for (const auto& [to, wire] : kNamed) {
        if (to == port) return wire;
    }
    return std::nullopt;
}

}  // namespace

Rig::Rig(const SystemSettings& settings, const MakeTap& make_tap)
    : settings_(settings),
      handle_(settings.handle, settings.person),
      pointer_(settings.handle),
      actuator_(settings.cutaneous),
      driven_(settings.cutaneous.device == FingertipDevice::kDrives
                  ? std::make_unique<Driven>(settings.cutaneous)
                  : nullptr),
      display_(settings.visual.pipeline),
      virtual_(settings_, nullptr, devices(),
               [make_tap](Port to, Channel& end) -> std::unique_ptr<Channel> {
                   const std::optional<Wire> wire = make_tap ? wire_to(to) : std::nullopt;
                   return wire ? make_tap(*wire, end) : nullptr;
               }),
      hand_(virtual_.network().of(Role::kVisual).outlet(Port::kMasterHand)) {
    if (!driven_) return;
    driven_->bus.a.wake(virtual_.loop().wake_mask(), virtual_.bit(Role::kCutaneous));
    driven_->bus.b.wake(virtual_.loop().wake_mask(), virtual_.loop().add(driven_->drives));
}

VirtualDevices Rig::devices() {
    VirtualDevices mine;
    const bool simulated = settings_.handle.kind == HandleKind::kSimulated;
    mine.handle = simulated ? static_cast<HapticDevice*>(&breakable_) : &pointer_;
    mine.person = simulated ? static_cast<OperatorPort*>(&handle_) : &pointer_;
    mine.follower = simulated ? nullptr : &pointer_;
    mine.actuator = driven_ ? static_cast<FingertipActuator*>(&driven_->actuator) : &actuator_;
    mine.display = &display_;
    return mine;
}

const TrialRecord& Rig::finish() {
    while (step()) {
    }
    return session().record();
}

const TrialRecord& Rig::run(const TrialConditions& conditions) {
    start(conditions);
    return finish();
}

void Rig::run_until(SessionTime time) {
    while (now() < time && step()) {
    }
}

bool Rig::run_until_sample(const std::function<bool(const TrajectorySample&)>& seen) {
    const auto& samples = session().record().samples;
    std::size_t looked_at = samples.size();
    while (step()) {
        for (; looked_at < samples.size(); ++looked_at) {
            if (seen(samples[looked_at])) return true;
        }
    }
    return false;
}

FlowCounters Rig::counters() const {
    FlowCounters sum;
    for (const NodeProcess* node : nodes()) sum.add(node->counters());
    return sum;
}

}  // namespace thimble::test
