#include "visual_node/window/visual_window.hpp"

#include <utility>

#include <spdlog/spdlog.h>

#include "common/runtime/node_program.hpp"

namespace thimble {
namespace {

WindowSettings window_settings(const VisualWindowOptions& options) {
    WindowSettings settings;
    settings.fullscreen = options.fullscreen;
    if (options.player) settings.width = 1100;  // a panel beside a scene as large as the subject's
    return settings;
}

std::unique_ptr<Beeper> make_beeper(const VisualSettings& settings) {
    if (!settings.sound) return nullptr;
    auto beeper = std::make_unique<Beeper>();
    if (!beeper->can_sound()) spdlog::warn(beeper->notice());
    return beeper;
}

// A subject has devices on the fingers.
std::optional<Vibration> make_vibration(const VisualSettings& settings, bool player) {
    if (!player || !settings.vibration) return std::nullopt;
    return std::optional<Vibration>(std::in_place, settings.vibration_device);
}

// Stamps of the master and of slave_sim count on this machine's clock where all of them are this machine.
bool one_clock(const NetworkSettings& network) {
    return network.host(Role::kMaster) == network.host(Role::kVisual) &&
           network.host(Role::kSlaveSim) == network.host(Role::kVisual);
}

nlohmann::ordered_json beeps_of(const std::vector<BeepTimes>& beeps) {
    auto list = nlohmann::ordered_json::array();
    for (const BeepTimes& beep : beeps) {
        list.push_back({{"asked_ns", to_nanoseconds(beep.asked)}, {"begun_ns", to_nanoseconds(beep.begun)}});
    }
    return list;
}

}  // namespace

VisualWindow::VisualWindow(const VisualSettings& settings, VisualWindowOptions options,
                           const NetworkSettings& network)
    : pointer_(options.pointer),
      window_(window_settings(options)),
      display_(settings.pipeline),
      hand_(settings.pointer_m_per_count),
      beeper_(make_beeper(settings)),
      overlay_(std::move(options.overlay)),
      instructions_(std::move(options.instructions)),
      vibration_(make_vibration(settings, options.player)),
      loop_({&window_, &display_, pointer_ ? &hand_ : nullptr, overlay_.get(), beeper_.get(), &instructions_,
             settings.subject_goes_on && !options.player, pointer_ && !options.player,
             vibration_ ? &*vibration_ : nullptr},
            settings.smoothing, one_clock(network)) {
    if (!options.screenshot.empty()) loop_.set_screenshot(options.screenshot);
    if (pointer_ && beeper_ != nullptr) loop_.set_notice(beeper_->notice());
}

void VisualWindow::describe(nlohmann::ordered_json& report) const {
    const FrameTimes& times = loop_.times();
    nlohmann::ordered_json window;
    window["end"] = to_string(loop_.end());
    window["frames"] = loop_.frames();
    window["scenes_unseen"] = display_.unseen();
    window["frame_interval"] = quantiles(times.interval);
    window["frame_to_swap"] = quantiles(times.draw);
    window["arrival_to_frame"] = quantiles(times.arrival_to_frame);
    if (times.one_clock()) {
        window["hand_to_slave_sim"] = quantiles(times.hand_to_slave);
        window["slave_sim_to_arrival"] = quantiles(times.slave_to_arrival);
        window["hand_to_swap"] = quantiles(times.hand_to_swap);
    }
    window["beeps"] = beeps_of(loop_.beeps());
    window["sound"] = beeper_ == nullptr     ? "off"
                      : beeper_->can_sound() ? "on"
                      : Beeper::built()      ? "no_device"
                                             : "not_built";
    report["window"] = window;
}

}  // namespace thimble
