#include "master/devices/falcon/falcon_exchange.hpp"

#include <array>
#include <optional>
#include <utility>

namespace thimble {
namespace {

// A report may come in two packets, or behind one that is empty. Later work belongs to the next turn.
constexpr int kReads = 2;
constexpr Duration kRead = std::chrono::milliseconds{1};

std::uint64_t pack(const FalconTriple& values, std::uint8_t flags, std::uint8_t count) {
    std::uint64_t word = (std::uint64_t{flags} << 48) | (std::uint64_t{count} << 56);
    for (std::size_t i = 0; i < 3; ++i)
        word |= std::uint64_t{static_cast<std::uint16_t>(values[i])} << (16 * i);
    return word;
}

FalconTriple values_of(std::uint64_t word) {
    FalconTriple values{};
    for (std::size_t i = 0; i < 3; ++i)
        values[i] = static_cast<std::int16_t>(static_cast<std::uint16_t>(word >> (16 * i)));
    return values;
}

std::uint8_t light_of(const FalconReport& report) {
    if (report.homed()) return kFalconGreen;
    return report.homed_legs == 0 ? kFalconRed : kFalconBlue;
}

std::uint8_t flags_of(std::uint64_t word) { return static_cast<std::uint8_t>(word >> 48); }
std::uint8_t count_of(std::uint64_t word) { return static_cast<std::uint8_t>(word >> 56); }

}  // namespace

void FalconExchange::command(const FalconTriple& motors) {
    command_.store(pack(motors, 0, ++commands_), std::memory_order_release);
}

FalconExchange::Latest FalconExchange::latest() const {
    if (!any_.load(std::memory_order_acquire)) return {};
    const std::uint64_t word = report_.load(std::memory_order_acquire);
    const std::uint8_t flags = flags_of(word);
    return {{values_of(word), static_cast<std::uint8_t>(flags & 0xfU), static_cast<std::uint8_t>(flags >> 4)},
            count_of(word),
            true};
}

std::uint8_t FalconExchange::take_buttons() { return pressed_.exchange(0) | latest().report.buttons; }

bool FalconExchange::turn() {
    const std::uint64_t word = command_.load(std::memory_order_acquire);
    unattended_ = word == carried_ ? unattended_ + 1 : 0;
    carried_ = word;
    FalconCommand command{values_of(word), true, light_};
    if (silent() || unattended_ > kUnattendedTurns) command.motors = {};
    const auto report = link_->write(encode(command)) ? listen() : std::nullopt;
    if (report) publish(*report);
    silent_.store(!report, std::memory_order_release);
    if (link_->lost()) lost_.store(true, std::memory_order_release);
    return !lost();
}

std::optional<FalconReport> FalconExchange::listen() {
    std::optional<FalconReport> report;
    for (int i = 0; i < kReads && !report; ++i) {
        std::array<std::uint8_t, 64> bytes{};
        report = reader_.take(std::span(bytes).first(link_->read(bytes, kRead)));
    }
    return report;
}

void FalconExchange::publish(const FalconReport& report) {
    pressed_ |= report.buttons;  // first, so that no reader misses it
    const auto flags = static_cast<std::uint8_t>(report.buttons | (report.homed_legs << 4));
    report_.store(pack(report.encoders, flags, ++reports_), std::memory_order_release);
    any_.store(true, std::memory_order_release);
    light_ = light_of(report);
}

void FalconExchange::start(std::function<void()> prepare) {
    thread_ = std::thread([this, prepare = std::move(prepare)] {
        if (prepare) prepare();
        while (!stop_.load(std::memory_order_acquire) && turn()) {
        }
    });
}

void FalconExchange::stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    if (!lost()) link_->write(encode(FalconCommand{}));
}

}  // namespace thimble
