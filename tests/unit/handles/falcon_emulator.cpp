#include "tests/unit/handles/falcon_emulator.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "master/devices/falcon/falcon_kinematics.hpp"

namespace thimble {
namespace {

constexpr std::uint16_t kSlow = 0x4138, kLoading = 0x0015, kFast = 0x0002;

}  // namespace

bool FalconEmulator::control(std::uint8_t request, std::uint16_t value) {
    if (stalled_control) return false;
    if (request == 0) {  // purge
        (value == 1 ? waiting_ : heard_).clear();
        return value == 1 || value == 2;
    }
    if (request == 3) {
        baud_ = value;
        if (value == kLoading && stage_ == Stage::kGreeting) stage_ = Stage::kBegin;
        return value == kSlow || value == kLoading || value == kFast;
    }
    // DTR up at the loader's speed resets the board.
    if (request == 1 && value == 0x0101 && baud_ == kSlow) {
        stage_ = Stage::kGreeting;
        running = false;
        loaded.clear();
    }
    return request == 1 || request == 2 || request == 4 || request == 9;
}

void FalconEmulator::receive(std::span<const std::uint8_t> bytes) {
    for (const std::uint8_t byte : bytes) take(byte);
}

void FalconEmulator::take(std::uint8_t byte) {
    if (!running) return take_boot(byte);
    if (baud_ != kFast) return;
    heard_.push_back(byte);
    if (heard_.size() > kFalconPacketBytes) heard_.pop_front();
    if (heard_.size() < kFalconPacketBytes) return;
    FalconPacket packet{};
    std::copy(heard_.begin(), heard_.end(), packet.begin());
    const auto command = decode_falcon_command(packet);
    if (!command) return;
    heard_.clear();
    commanded = *command;
    ++commands;
    if (commanded.motors != FalconTriple{}) ++commands_with_force;
    if (silent) return;
    FalconPacket reply = encode(report);
    if (garbled_reports) reply[7] = 0xff;
    answer(std::span(reply).first(short_reports ? 9 : reply.size()));
}

void FalconEmulator::take_boot(std::uint8_t byte) {
    static constexpr std::array<std::uint8_t, 3> kGreeting{0x0a, 0x43, 0x0d};
    static constexpr std::array<std::uint8_t, 4> kGreeted{0x0a, 0x44, 0x2c, 0x0d};
    if (stage_ == Stage::kGreeting && !deaf_loader) {
        heard_.push_back(byte);
        if (heard_.size() > kGreeting.size()) heard_.pop_front();
        if (!std::equal(heard_.begin(), heard_.end(), kGreeting.begin(), kGreeting.end())) return;
        heard_.clear();
        if (zero_before_greeting) waiting_.push_back(0);
        const std::size_t missing = greetings_cut_short > 0 ? 2 : 0;
        if (missing > 0) --greetings_cut_short;
        answer(std::span(kGreeted).first(kGreeted.size() - missing));
    } else if (stage_ == Stage::kBegin && byte == 0x41) {
        stage_ = Stage::kImage;
        waiting_.push_back(byte);
    } else if (stage_ == Stage::kImage) {
        const bool wrong = wrong_echo_at == loaded.size();
        if (wrong) wrong_echo_at.reset();
        waiting_.push_back(wrong ? static_cast<std::uint8_t>(~byte) : byte);
        loaded.push_back(byte);
        if (loaded.size() == image_bytes) running = true;
    }
}

std::vector<std::uint8_t> FalconEmulator::transmit(std::size_t at_most) {
    const auto count = static_cast<std::ptrdiff_t>(std::min(at_most, waiting_.size()));
    std::vector<std::uint8_t> bytes(waiting_.begin(), waiting_.begin() + count);
    waiting_.erase(waiting_.begin(), waiting_.begin() + count);
    return bytes;
}

void FalconEmulator::put_hand_at(const DeviceVector& position_m) {
    const auto angles_rad = falcon_leg_angles_rad(position_m);
    const double step_rad = falcon_leg_angle_rad(1) - falcon_leg_angle_rad(0);
    for (std::size_t leg = 0; leg < 3; ++leg) {
        report.encoders[leg] =
            static_cast<std::int16_t>(std::lround(((*angles_rad)[leg] - falcon_leg_angle_rad(0)) / step_rad));
    }
}

bool EmulatedFalconLink::control(std::uint8_t request, std::uint16_t value) {
    return !device_->unplugged && device_->control(request, value);
}

bool EmulatedFalconLink::write(std::span<const std::uint8_t> bytes) {
    if (device_->unplugged) return false;
    empty_reads_ = device_->reads_before_report;
    device_->receive(bytes);
    return true;
}

std::size_t EmulatedFalconLink::read(std::span<std::uint8_t> room, Duration /*limit*/) {
    if (lost() || empty_reads_-- > 0) return 0;
    const auto bytes = device_->transmit(std::min(room.size(), device_->packet_bytes));
    std::copy(bytes.begin(), bytes.end(), room.begin());
    return bytes.size();
}

}  // namespace thimble
