#include "cutaneous_node/emulator/drive_emulator.hpp"

#include <algorithm>

namespace thimble {
namespace {

using std::chrono::milliseconds;

constexpr std::uint16_t kReceiveMap = 0x1600, kTransmitMap = 0x1a00;
constexpr std::uint32_t kTurnedOff = 0x80000000U;

}  // namespace

DriveEmulator::DriveEmulator(std::uint8_t node, const PlantParameters& plant)
    : node_(node), dictionary_(node), plant_(plant) {}

void DriveEmulator::reset(SessionTime now, CanBus& bus) {
    advance(now);
    dictionary_ = ObjectDictionary(node_);
    automaton_ = {};
    plant_.off();
    network_ = NetworkState::kPreOperational;
    next_heartbeat_ = master_heard_ = kNever;
    target_.reset();
    silent_ = heartbeat_off_ = data_off_ = short_data_ = false;
    for (int i = 0; i < (doubled_ ? 2 : 1); ++i) bus.send(heartbeat_frame(node_, NetworkState::kBootUp));
}

void DriveEmulator::advance(SessionTime now) {
    if (plant_time_ != kNever) plant_.advance(to_seconds(now - plant_time_));
    plant_time_ = now;
}

void DriveEmulator::on_frame(SessionTime now, const CanFrame& frame, CanBus& bus) {
    const bool to_reset = frame.id == cob(CobBase::kNetwork);
    if (silent_ && !to_reset) return;
    advance(now);
    if (to_reset) return on_network(now, frame, bus);
    if (frame.id == cob(CobBase::kSync)) return on_sync(bus);
    if (frame.id == cob(CobBase::kSdoRequest, node_)) return on_sdo(now, frame, bus);
    if (frame.id == dictionary_.get({0x1400, 1})) return on_target(frame, bus);
    const std::uint32_t master = dictionary_.get({0x1016, 1}) >> 16U & 0x7fU;
    if (master != 0 && frame.id == cob(CobBase::kHeartbeat, static_cast<std::uint8_t>(master)))
        master_heard_ = now;
}

void DriveEmulator::on_network(SessionTime now, const CanFrame& frame, CanBus& bus) {
    if (frame.length != 2 || (frame.data[1] != 0 && frame.data[1] != node_)) return;
    switch (static_cast<NetworkCommand>(frame.data[0])) {
        case NetworkCommand::kStart:
            network_ = NetworkState::kOperational;
            return;
        case NetworkCommand::kStop:
        case NetworkCommand::kPreOperational:
            network_ = frame.data[0] == 2 ? NetworkState::kStopped : NetworkState::kPreOperational;
            next_heartbeat_ = now;
            automaton_.obey(kControlDisableVoltage);
            return obey_objects();
        case NetworkCommand::kResetNode:
        case NetworkCommand::kResetCommunication:
            return reset(now, bus);
    }
}

void DriveEmulator::refuse(ObjectKey key, SdoAbort why) { refused_ = Refused{key, why}; }

void DriveEmulator::on_sdo(SessionTime now, const CanFrame& frame, CanBus& bus) {
    const auto request = read_sdo_request(frame);
    if (!request || request->kind == SdoKind::kAbort) return;
    Sdo answer;
    if (refused_ && refused_->key == request->key) {
        answer = {SdoKind::kAbort, request->key, static_cast<std::uint32_t>(refused_->why), 4};
    } else {
        answer = dictionary_.answer(*request);
    }
    if (answer.kind == SdoKind::kWrite && request->key == ObjectKey{0x1017, 0})
        next_heartbeat_ = after_heartbeat(now);
    // The mode takes effect where it can be read back.
    dictionary_.set({0x6061, 0}, dictionary_.get({0x6060, 0}));
    for (int i = 0; i < (doubled_ ? 2 : 1); ++i) bus.send(sdo_reply(node_, answer));
}

void DriveEmulator::on_target(const CanFrame& frame, CanBus& bus) {
    if (network_ != NetworkState::kOperational) return;
    if (frame.length < pdo_bytes(dictionary_, kReceiveMap)) return emergency(0x8210, bus);
    target_ = frame;
}

void DriveEmulator::on_sync(CanBus& bus) {
    if (network_ != NetworkState::kOperational) return;
    if (target_) {
        unpack_pdo(dictionary_, kReceiveMap, *target_);
        target_.reset();
        automaton_.obey(static_cast<std::uint16_t>(dictionary_.get({0x6040, 0})));
    }
    obey_objects();
    const std::uint32_t id = dictionary_.get({0x1800, 1});
    if ((id & kTurnedOff) != 0 || data_off_) return;
    dictionary_.set({0x6041, 0}, automaton_.statusword());
    dictionary_.set({0x6064, 0}, static_cast<std::uint32_t>(plant_.counts()));
    dictionary_.set({0x6077, 0}, static_cast<std::uint16_t>(plant_.torque_per_mille()));
    CanFrame frame = pack_pdo(dictionary_, kTransmitMap, id & 0x7ffU);
    if (short_data_) frame.length = std::min<std::uint8_t>(frame.length, 6);
    for (int i = 0; i < (doubled_ ? 2 : 1); ++i) bus.send(frame);
}

// The power stage does what the automaton and the mode say.
void DriveEmulator::obey_objects() {
    if (automaton_.state() != DriveState::kOperationEnabled) return plant_.off();
    switch (static_cast<DriveMode>(dictionary_.get({0x6061, 0}))) {
        case DriveMode::kSyncTorque:
            return plant_.ask_torque(static_cast<std::int16_t>(dictionary_.get({0x6071, 0})));
        case DriveMode::kSyncPosition:
            return plant_.ask_position(static_cast<std::int32_t>(dictionary_.get({0x607a, 0})));
        default:
            return plant_.off();
    }
}

void DriveEmulator::emergency(std::uint16_t code, CanBus& bus) {
    automaton_.fail();
    plant_.off();
    dictionary_.set({0x603f, 0}, code);
    dictionary_.set({0x1001, 0}, 1);
    bus.send(emergency_frame(node_, {code, 1}));
}

SessionTime DriveEmulator::next_wakeup() const {
    if (silent_) return kNever;
    SessionTime next = next_heartbeat_;
    if (master_heard_ != kNever) {
        const auto limit = milliseconds{dictionary_.get({0x1016, 1}) & 0xffffU};
        next = std::min(next, master_heard_ + limit + Duration{1});
    }
    return next;
}

SessionTime DriveEmulator::after_heartbeat(SessionTime now) const {
    const std::uint32_t period_ms = dictionary_.get({0x1017, 0});
    return period_ms == 0 ? kNever : now + milliseconds{period_ms};
}

void DriveEmulator::tick(SessionTime now, CanBus& bus) {
    if (silent_) return;
    advance(now);
    if (now >= next_heartbeat_) {
        next_heartbeat_ = after_heartbeat(now);
        if (!heartbeat_off_) bus.send(heartbeat_frame(node_, network_));
    }
    if (master_heard_ != kNever &&
        now - master_heard_ > milliseconds{dictionary_.get({0x1016, 1}) & 0xffffU}) {
        master_heard_ = kNever;
        emergency(0x8130, bus);
    }
}

}  // namespace thimble
