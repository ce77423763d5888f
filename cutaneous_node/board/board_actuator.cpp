#include "cutaneous_node/board/board_actuator.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace thimble {
namespace {

constexpr Duration kBoardRead = std::chrono::milliseconds{1};  // a command waits no longer for a status
constexpr Duration kOwnStall = std::chrono::milliseconds{20};  // between turns or looks: not the board's
constexpr std::uint8_t kNoTrouble = 0;

bool is_board(const HidDevice& device) {
    return device.usage_page == kBoardUsagePage && device.usage == kBoardUsage;
}

// Texts in the order of Trouble, which follows BoardFault.
constexpr std::array<std::string_view, 10> kTroubles{
    "",
    "fingertip board: over-current, so it released the finger; look for a jammed cable, then unplug it and "
    "plug it in again",
    "fingertip board: over-temperature, so it released the finger; let it cool down",
    "fingertip board: its force sensor failed, so it released the finger; check the sensor's wires, then "
    "unplug it and plug it in again",
    "fingertip board: its supply failed, so it released the finger; check the supply voltage",
    "fingertip board: its calibration is lost, so it released the finger; take both fingers out, unplug it "
    "and plug it in again",
    "fingertip board: it reports an internal fault (docs/board-protocol.md, code 255), so it released the "
    "finger; unplug it and plug it in again",
    "fingertip board: not plugged in, or this user may not open it; plug it in, and run thimble doctor",
    "fingertip board: no valid report for 100 ms, or always the same one; unplug it and plug it in again, "
    "and check report rate, CRC and sequence in its firmware",
    "fingertip board: it uses another version of docs/board-protocol.md; load firmware of version 1 into it"};

}  // namespace

void BoardActuator::command(SessionTime now, Finger finger, double force_N) {
    // Written so that a NaN is no force.
    const bool pressed = finger != Finger::kNone && force_N > 0;
    say(now, true, finger, pressed ? std::min(force_N, limit_N_) : 0);
}

void BoardActuator::release(SessionTime now) { say(now, false, Finger::kNone, 0); }

void BoardActuator::say(SessionTime now, bool press, Finger finger, double force_N) {
    const auto force_mN = static_cast<std::uint16_t>(std::lround(std::min(1000 * force_N, 65535.0)));
    ++sequence_;
    commanded_[sequence_] = now;
    command_.store({{sequence_, press, finger == Finger::kIndex ? force_mN : std::uint16_t{0},
                     finger == Finger::kThumb ? force_mN : std::uint16_t{0}}},
                   std::memory_order_release);
    look(now);
}

// Counts the time without a sign of life itself: the thread may stand in a write.
void BoardActuator::look(SessionTime now) {
    const Duration passed = now - from_nanoseconds(loop_seen_ns_.load(std::memory_order_relaxed));
    const std::uint32_t signs = signs_.load(std::memory_order_acquire);
    if (signs != signs_seen_) {
        signs_seen_ = signs;
        waited_ = Duration::zero();
    } else if (passed <= kOwnStall) {
        waited_ += passed;
    }
    loop_seen_ns_.store(to_nanoseconds(now), std::memory_order_release);
}

bool BoardActuator::silent() const {
    return waited_ >= kSilence && signs_.load(std::memory_order_acquire) == signs_seen_;
}

FingertipForce BoardActuator::output(SessionTime now) {
    look(now);
    const BoardFelt felt = felt_.load(std::memory_order_acquire);
    const double index_N = 1e-3 * felt.index_mN, thumb_N = 1e-3 * felt.thumb_mN;
    const SessionTime sample_time = commanded_[felt.sequence];
    const double strongest_N = std::max(index_N, thumb_N);
    if (strongest_N == 0 || silent()) return {Finger::kNone, 0, sample_time};
    return {index_N >= thumb_N ? Finger::kIndex : Finger::kThumb, strongest_N, sample_time};
}

std::string_view BoardActuator::fault() const {
    const std::uint8_t trouble = felt_.load(std::memory_order_acquire).trouble;
    const bool unnoticed = trouble == kNoTrouble && silent();
    return kTroubles.at(unnoticed ? static_cast<std::uint8_t>(Trouble::kSilent) : trouble);
}

// A board that does not press, or is in trouble, presses nothing, whatever its sensors say.
void BoardActuator::publish(const BoardStatus& status, std::uint8_t trouble) {
    const bool felt = status.pressing && trouble == kNoTrouble;
    felt_.store({felt ? status.index_mN : std::uint16_t{0}, felt ? status.thumb_mN : std::uint16_t{0},
                 status.sequence, trouble},
                std::memory_order_release);
}

std::optional<std::size_t> BoardActuator::choose(const std::vector<HidDevice>& present,
                                                 std::string& trouble) {
    const auto found = distinct_devices(
        present, [this](const HidDevice& device) { return is_board(device) && choice_.matches(device); });
    if (found.size() == 1) return found.front();
    if (found.empty()) {
        trouble =
            "no fingertip board is plugged in (usage page ff54, docs/board-protocol.md): plug one in; "
            "thimble looks for it once a second";
    } else {
        trouble =
            fmt::format("two fingertip boards, {} and {}: name one in [cutaneous.board] device_id or serial",
                        to_string(present[found[0]]), to_string(present[found[1]]));
    }
    return std::nullopt;
}

bool BoardActuator::attach(const HidDevice& /*device*/, std::span<const std::uint8_t> /*descriptor*/,
                           std::string& /*trouble*/) {
    fresh_ = true;
    written_ = {};
    written_at_ = {};
    return true;
}

bool BoardActuator::turn(SessionTime now, HidLink& link) {
    if (fresh_) {
        turned_ = now;
        hear(now);  // from now on it is expected to speak
    }
    fresh_ = false;
    if (now - turned_ > kOwnStall) heard_ += now - turned_;
    turned_ = now;
    if (!write(now, link)) return false;
    std::array<std::uint8_t, 64> report{};
    const int size = link.read(report, kBoardRead);
    if (size < 0) return false;
    if (size > 0) take(now, std::span(report).first(static_cast<std::size_t>(size)));
    if (now - heard_ < kSilence) return true;
    publish({}, static_cast<std::uint8_t>(Trouble::kSilent));
    return true;
}

void BoardActuator::hear(SessionTime now) {
    heard_ = now;
    signs_.fetch_add(1, std::memory_order_release);
}

void BoardActuator::take(SessionTime now, std::span<const std::uint8_t> report) {
    if (const auto status = decode_board_status(report)) {
        // An unchanged report after new commands means that the board hangs.
        const std::uint8_t told = written_.sequence;
        if (status->sequence == told || status->sequence != echoed_) hear(now);
        echoed_ = status->sequence;
        if (now - heard_ >= kSilence) return;
        return publish(*status, static_cast<std::uint8_t>(status->fault));
    }
    if (is_of_another_version(report)) {
        hear(now);
        return publish({}, static_cast<std::uint8_t>(Trouble::kOtherVersion));
    }
    bad_reports_.fetch_add(1, std::memory_order_relaxed);
}

bool BoardActuator::write(SessionTime now, HidLink& link) {
    BoardCommand command = command_.load(std::memory_order_acquire).command;
    const auto seen = from_nanoseconds(loop_seen_ns_.load(std::memory_order_acquire));
    if (command.press && now - seen > kLoopSilence) command = {command.sequence, false, 0, 0};
    if (command == written_ && now - written_at_ < kRepeat) return true;
    written_ = command;
    written_at_ = now;
    return link.write(encode(command));
}

void BoardActuator::detach() { publish({}, static_cast<std::uint8_t>(Trouble::kAbsent)); }

}  // namespace thimble
