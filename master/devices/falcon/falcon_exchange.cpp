#include "master/devices/falcon/falcon_exchange.hpp"

#include <array>
#include <optional>
#include <utility>

namespace thimble {
namespace {

// A report may come in two packets, or behind one that is empty. Later work belongs to the next turn.
constexpr int kReads = 2;
constexpr Duration kRead = std::chrono::milliseconds{1};

std::uint8_t light_of(const FalconReport& report) {
    if (report.homed()) return kFalconGreen;
    return report.homed_legs == 0 ? kFalconRed : kFalconBlue;
}

}  // namespace

void FalconExchange::command(const FalconTriple& motors) {
    command_.store({motors, 0, ++commands_}, std::memory_order_release);
}

FalconExchange::Latest FalconExchange::latest() const {
    if (!any_.load(std::memory_order_acquire)) return {};
    const FalconWord word = report_.load(std::memory_order_acquire);
    return {{word.values, static_cast<std::uint8_t>(word.flags & 0xfU),
             static_cast<std::uint8_t>(word.flags >> 4)},
            word.count,
            true};
}

std::uint8_t FalconExchange::take_buttons() { return pressed_.exchange(0) | latest().report.buttons; }

bool FalconExchange::turn() {
    const FalconWord word = command_.load(std::memory_order_acquire);
    unattended_ = word == carried_ ? unattended_ + 1 : 0;
    carried_ = word;
    FalconCommand command{word.values, true, light_};
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
    report_.store({report.encoders, flags, ++reports_}, std::memory_order_release);
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
