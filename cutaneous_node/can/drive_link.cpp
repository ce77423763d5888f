#include "cutaneous_node/can/drive_link.hpp"

#include <algorithm>

namespace thimble {
namespace {

using std::chrono::milliseconds;

constexpr Duration kAskAgain = milliseconds{100};
constexpr Duration kResetAgain = milliseconds{1500};
// A second device with the same node id boots at about the same time.
constexpr Duration kSettleTime = milliseconds{50};
constexpr int kDoubtfulResets = 3;
// The answers that wait after a pause of 0.1 s at 1 kHz. Late answers are no second device.
constexpr std::int64_t kMostOwed = 128;
constexpr std::uint32_t kNotValid = 0x80000000U;  // bit 31 of a PDO's identifier
constexpr std::uint32_t kNoRtr = 0x40000000U;     // bit 30 of a TPDO's: drives without remote frames refuse 0

std::uint32_t milliseconds_of(Duration duration) {
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>(duration / milliseconds{1}, 1, 65535));
}

constexpr std::uint32_t mapped(std::uint32_t index, std::uint32_t bits) { return index << 16U | bits; }

}  // namespace

DriveLink::DriveLink(const CanMasterSettings& settings, std::size_t index)
    : settings_(&settings), index_(index), node_(settings.nodes[index]) {
    plan();
}

void DriveLink::write(const char* name, ObjectKey key, std::uint32_t value, std::uint8_t bytes) {
    steps_.push_back({name, {SdoKind::kWrite, key, value, bytes}});
}

void DriveLink::plan() {
    const std::uint32_t silent_ms = milliseconds_of(settings_->silent_after);
    const auto mode = static_cast<std::uint8_t>(settings_->mode);
    steps_.push_back({"device type 0x1000", {SdoKind::kRead, {0x1000, 0}}, Check::kDeviceType});
    steps_.push_back({"supported modes 0x6502", {SdoKind::kRead, {0x6502, 0}}, Check::kModes});
    steps_.push_back({"rated torque 0x6076", {SdoKind::kRead, {0x6076, 0}}, Check::kRatedTorque});
    write("consumer heartbeat 0x1016", {0x1016, 1}, std::uint32_t{settings_->master_node} << 16U | silent_ms,
          4);
    // A third of the limit: two heartbeats may be late or lost.
    write("producer heartbeat 0x1017", {0x1017, 0}, std::max(silent_ms / 3, 1U), 2);
    write("abort connection 0x6007", {0x6007, 0}, 2, 2);  // disable voltage
    write("fault reaction 0x605E", {0x605e, 0}, 0, 2);    // the same
    plan_mapping();
    if (settings_->mode == DriveMode::kSyncPosition) plan_cycle();
    write("torque 0x6071", {0x6071, 0}, 0, 2);
    write("mode 0x6060", {0x6060, 0}, mode, 1);
    steps_.push_back({"mode shown 0x6061", {SdoKind::kRead, {0x6061, 0}}, Check::kMode});
}

// In the order CiA 301 asks for: off, no entries, entries, their number, when, on.
void DriveLink::plan_mapping() {
    const bool position = settings_->mode == DriveMode::kSyncPosition;
    const std::uint32_t receive = cob(CobBase::kReceive1, node_),
                        transmit = cob(CobBase::kTransmit1, node_) | kNoRtr;
    write("RPDO1 off", {0x1400, 1}, receive | kNotValid, 4);
    write("RPDO1 cleared", {0x1600, 0}, 0, 1);
    write("RPDO1 controlword", {0x1600, 1}, mapped(0x6040, 16), 4);
    write("RPDO1 target", {0x1600, 2}, position ? mapped(0x607a, 32) : mapped(0x6071, 16), 4);
    write("RPDO1 mapped", {0x1600, 0}, 2, 1);
    write("RPDO1 by SYNC", {0x1400, 2}, 1, 1);
    write("RPDO1 on", {0x1400, 1}, receive, 4);
    write("TPDO1 off", {0x1800, 1}, transmit | kNotValid, 4);
    write("TPDO1 cleared", {0x1a00, 0}, 0, 1);
    write("TPDO1 statusword", {0x1a00, 1}, mapped(0x6041, 16), 4);
    write("TPDO1 position", {0x1a00, 2}, mapped(0x6064, 32), 4);
    write("TPDO1 torque", {0x1a00, 3}, mapped(0x6077, 16), 4);
    write("TPDO1 mapped", {0x1a00, 0}, 3, 1);
    write("TPDO1 by SYNC", {0x1800, 2}, 1, 1);
    write("TPDO1 on", {0x1800, 1}, transmit, 4);
}

// A drive interpolates between two positions, by itself for 1 ms as a rule: it would go and stand still within each cycle.
void DriveLink::plan_cycle() {
    const auto time = interpolation_time(settings_->cycle);
    if (!time) return;  // the settings refuse it
    const std::size_t first = steps_.size();
    const auto cycle_us = static_cast<std::uint32_t>(settings_->cycle / std::chrono::microseconds{1});
    write("cycle 0x1006", {0x1006, 0}, cycle_us, 4);
    write("interpolation unit 0x60C2", {0x60c2, 2}, static_cast<std::uint8_t>(time->exponent), 1);
    write("interpolation time 0x60C2", {0x60c2, 1}, time->count, 1);
    for (std::size_t i = first; i < steps_.size(); ++i) steps_[i].optional = true;
}

void DriveLink::enter(SessionTime now, Stage stage) {
    stage_ = stage;
    since_ = asked_ = heartbeat_ = data_ = now;
}

void DriveLink::fail(DriveFaultKind kind, std::uint32_t code, const char* step) {
    if (!fault_) fault_ = DriveFault{kind, index_, step, code};
}

void DriveLink::begin(SessionTime now, CanBus& bus) {
    boot_ups_ = 0;
    enter(now, Stage::kBoot);
    bus.send(network_frame(NetworkCommand::kResetNode, node_));
}

void DriveLink::ask(SessionTime now, CanBus& bus) {
    asked_ = now;
    bus.send(sdo_request(node_, steps_[step_].sdo));
}

void DriveLink::on_frame(SessionTime now, const CanFrame& frame, CanBus& bus) {
    switch (static_cast<CobBase>(cob_base(frame.id))) {
        case CobBase::kHeartbeat:
            return on_heartbeat(now, frame);
        case CobBase::kSdoReply:
            if (stage_ == Stage::kConfigure) on_reply(now, frame, bus);
            return;
        case CobBase::kTransmit1:
            if (exchanges()) on_data(now, frame);
            return;
        case CobBase::kEmergency:
            return on_emergency(frame);
        default:
            return;
    }
}

void DriveLink::on_heartbeat(SessionTime now, const CanFrame& frame) {
    if (frame.length != 1) return;
    const auto state = static_cast<NetworkState>(frame.data[0]);
    heartbeat_ = now;
    if (state == NetworkState::kBootUp) {
        if (stage_ == Stage::kBoot)
            enter(now, Stage::kSettle);
        else if (stage_ != Stage::kSettle)
            return fail(DriveFaultKind::kRebooted);
        ++boot_ups_;
    } else if (stage_ == Stage::kStart && state == NetworkState::kOperational) {
        enter(now, Stage::kEnable);
    }
}

void DriveLink::on_reply(SessionTime now, const CanFrame& frame, CanBus& bus) {
    const auto reply = read_sdo_reply(frame);
    const Step& step = steps_[step_];
    if (!reply || reply->key != step.sdo.key) return;  // late, of a request that was asked twice
    if (!accepted(step, *reply)) return;
    if (++step_ == steps_.size()) {
        enter(now, Stage::kStart);
        bus.send(network_frame(NetworkCommand::kStart, node_));
        return;
    }
    since_ = now;
    ask(now, bus);
}

bool DriveLink::accepted(const Step& step, const Sdo& reply) {
    if (reply.kind != SdoKind::kAbort) return reply.kind == step.sdo.kind && checked(step, reply.value);
    const auto why = static_cast<SdoAbort>(reply.value);
    if (step.optional && (why == SdoAbort::kNoObject || why == SdoAbort::kNoSubIndex)) return true;
    fail(DriveFaultKind::kAborted, reply.value, step.name);
    return false;
}

bool DriveLink::checked(const Step& step, std::uint32_t value) {
    const auto mode = static_cast<std::uint8_t>(settings_->mode);
    switch (step.check) {
        case Check::kNone:
            return true;
        case Check::kDeviceType:
            if ((value & 0xffffU) != 0x0192U) fail(DriveFaultKind::kNotThatDrive, value);
            break;
        case Check::kModes:
            if ((value >> (mode - 1U) & 1U) == 0) fail(DriveFaultKind::kNoMode, value);
            break;
        case Check::kRatedTorque:
            if (value == 0) fail(DriveFaultKind::kNoRatedTorque);
            rated_torque_ = value;
            break;
        case Check::kMode:
            return (value & 0xffU) == mode;  // else it is asked again until the time limit
    }
    return !fault_;
}

void DriveLink::on_emergency(const CanFrame& frame) {
    const auto emergency = read_emergency(frame);
    if (!emergency || emergency->code == 0) return;
    // Before operation it may be an old error, which enabling resets.
    if (stage_ == Stage::kOperate) fail(DriveFaultKind::kEmergency, emergency->code);
}

void DriveLink::on_data(SessionTime now, const CanFrame& frame) {
    if (frame.length != 8) return fail(DriveFaultKind::kDataLength, frame.length);
    // One answer to each SYNC: more come from two devices, however late they are.
    // (Before operation a drive may say where it stands without being asked.)
    if (owed_ == 0) {
        if (stage_ == Stage::kOperate) fail(DriveFaultKind::kDuplicate);
        return;
    }
    --owed_;
    if (frame.order < data_order_) return;  // an older measurement than the one that is known
    data_order_ = frame.order;
    answered_ = true;
    unanswered_ = false;
    data_ = now;
    feedback_.statusword = static_cast<std::uint16_t>(load(frame, 0, 2));
    feedback_.position_counts = static_cast<std::int32_t>(load(frame, 2, 4));
    feedback_.torque_per_mille = static_cast<std::int16_t>(load(frame, 6, 2));
    feedback_.sample_time = sync_;
    const DriveState state = state_of(feedback_.statusword);
    if (stage_ == Stage::kOperate) {
        if (state != DriveState::kOperationEnabled)
            fail(DriveFaultKind::kLeftOperation, feedback_.statusword);
        return;
    }
    const bool again = control_ == kControlFaultReset;  // an edge needs the bit low in between
    control_ = again ? kControlDisableVoltage : control_towards_operation(state);
    if (settings_->mode == DriveMode::kSyncPosition) target_ = feedback_.position_counts;
    if (state == DriveState::kOperationEnabled) enter(now, Stage::kOperate);
}

void DriveLink::check_silence(SessionTime now) {
    if (now - heartbeat_ > settings_->silent_after) fail(DriveFaultKind::kHeartbeatLost);
    // Twice the limit: a drive that is silent altogether loses its heartbeat first, which is the better message.
    if (now - data_ > 2 * settings_->silent_after) fail(DriveFaultKind::kDataLost);
}

void DriveLink::tick(SessionTime now, CanBus& bus) {
    const Duration passed = now - since_;
    const Duration answer_within = std::max(settings_->answer_limit, settings_->silent_after);
    switch (stage_) {
        case Stage::kBoot:
            if (passed > settings_->boot_limit) return fail(DriveFaultKind::kNoBootUp);
            if (now - asked_ < kResetAgain) return;
            asked_ = now;
            bus.send(network_frame(NetworkCommand::kResetNode, node_));
            return;
        case Stage::kSettle:
            if (passed < kSettleTime) return;
            // A drive that has just been switched on repeats its boot-up once. Two devices with one node id repeat it
            // after every reset.
            if (boot_ups_ > 1 && ++resets_ == kDoubtfulResets) return fail(DriveFaultKind::kDuplicate);
            if (boot_ups_ > 1) return begin(now, bus);
            enter(now, Stage::kConfigure);
            return ask(now, bus);
        case Stage::kConfigure:
            if (passed > answer_within) return fail(DriveFaultKind::kNoAnswer, 0, steps_[step_].name);
            if (now - asked_ >= kAskAgain) ask(now, bus);
            return;
        case Stage::kStart:
            // The answer is a heartbeat, which comes when it is due.
            if (passed > answer_within) return fail(DriveFaultKind::kNoAnswer, 0, "start (NMT)");
            if (now - asked_ < kAskAgain) return;
            asked_ = now;
            bus.send(network_frame(NetworkCommand::kStart, node_));
            return;
        case Stage::kEnable:
            if (passed > settings_->enable_limit)
                fail(DriveFaultKind::kStuck, feedback_.statusword, "enable");
            return check_silence(now);
        case Stage::kOperate:
            return check_silence(now);
    }
}

void DriveLink::send_target(CanBus& bus, bool slack) {
    const bool position = settings_->mode == DriveMode::kSyncPosition;
    CanFrame frame;
    frame.id = cob(CobBase::kReceive1, node_);
    frame.length = position ? 6 : 4;
    store(frame, 0, 2, slack ? kControlDisableVoltage : control_);
    const std::int32_t rest = position ? feedback_.position_counts : 0;
    store(frame, 2, frame.length - 2U, static_cast<std::uint32_t>(slack ? rest : target_));
    bus.send(frame);
}

void DriveLink::on_sync(SessionTime now) {
    sync_ = now;
    unanswered_ = !answered_;
    answered_ = false;
    // Answers that arrive together after a short silence are late ones of this drive, too.
    owed_ = std::min(owed_ + 1, std::max(kMostOwed, 2 * settings_->silent_after / settings_->cycle));
}

}  // namespace thimble
