#include "visual_node/window/visual_window.hpp"

#include <csignal>
#include <optional>
#include <utility>

#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/runtime/node_report.hpp"
#include "visual_node/visual_process.hpp"
#include "visual_node/window/window_display.hpp"
#include "visual_node/window/window_loop.hpp"

namespace thimble {
namespace {

WindowSettings window_settings(const VisualSettings& visual, bool player) {
    WindowSettings settings;
    settings.fullscreen = visual.fullscreen;
    if (!player) return settings;
    settings.width = 1280;
    settings.height = 800;
    settings.scale_from_width = 1150;  // the panel's rows need this
    settings.scale_from_height = 700;
    return settings;
}

std::unique_ptr<Beeper> make_beeper(const VisualSettings& settings) {
    if (!settings.sound) return nullptr;
    auto beeper = std::make_unique<Beeper>();
    if (!beeper->can_sound()) spdlog::warn(beeper->notice());
    return beeper;
}

bool shows_beep(const VisualSettings& settings, const Beeper* beeper) {
    const bool sound = beeper != nullptr && beeper->can_sound();
    return settings.beep_shown == BeepShown::kAlways ||
           (settings.beep_shown == BeepShown::kWithoutSound && !sound);
}

// Subjects wear fingertip devices, so only others get vibration.
std::optional<Vibration> make_vibration(const VisualSettings& settings, bool player) {
    if (!player || !settings.vibration) return std::nullopt;
    return std::optional<Vibration>(std::in_place, settings.vibration_device);
}

HandKind hand_kind(const VisualSettings& settings) {
    if (settings.hid) return HandKind::kDevice;
    return settings.keyboard ? HandKind::kKeyboard : HandKind::kMouse;
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

class WindowVisual final : public NodeInstance {
  public:
    WindowVisual(const VisualSettings& settings, VisualWindowOptions options, Sockets& sockets,
                 std::uint64_t instance);

    NodeProcess& process() override { return process_; }
    void describe(nlohmann::ordered_json& report) const override;
    bool has_foreground() const override { return true; }
    void foreground(const std::function<bool()>& stopped) override {
        if (loop_.run(stopped) == WindowEnd::kAsked || (!player_ && !subject_points_)) return;
        // Ends the node: without a window a subject could only wait for the timeout. The session then knows.
        static_cast<void>(std::raise(SIGTERM));
        if (player_) return;
        throw Error(ExitCode::kRunFailed,
                    "the subject's window has lost its screen, so the mouse is lost too");
    }

  private:
    bool player_;          // whose window ends the session
    bool subject_points_;  // nothing that a subject does closes the window
    GlWindow window_;      // before all else: without a screen nothing else is worth trying
    WindowDisplay display_;
    PointerHand hand_;
    std::unique_ptr<Beeper> beeper_;
    std::unique_ptr<Overlay> overlay_;
    PageSet pages_;
    std::optional<Vibration> vibration_;
    WindowLoop loop_;
    StalePolicy stale_;
    VisualProcess process_;
};

WindowVisual::WindowVisual(const VisualSettings& settings, VisualWindowOptions options, Sockets& sockets,
                           std::uint64_t instance)
    : player_(options.player),
      subject_points_(settings.pointer && !options.player),
      window_(window_settings(settings, options.player)),
      display_(settings.pipeline),
      hand_(settings.pointer_m_per_count),
      beeper_(make_beeper(settings)),
      overlay_(std::move(options.overlay)),
      pages_(std::move(options.pages)),
      vibration_(make_vibration(settings, options.player)),
      loop_(
          {&window_, &display_, settings.pointer ? &hand_ : nullptr, overlay_.get(), beeper_.get(), &pages_,
           settings.subject_goes_on && !options.player, subject_points_, vibration_ ? &*vibration_ : nullptr,
           shows_beep(settings, beeper_.get()), hand_kind(settings), settings.position_scale},
          settings.smoothing, one_clock(sockets.settings())),
      stale_(settings.stale),
      process_(instance, settings, sockets, display_, settings.pointer ? &hand_ : nullptr) {
    if (!options.screenshot.empty()) loop_.set_screenshot(options.screenshot);
    if (!settings.pointer || beeper_ == nullptr || beeper_->can_sound()) return;
    const bool shown = shows_beep(settings, beeper_.get());
    loop_.set_notice(beeper_->notice() + (shown ? ", and a bright frame shows it" : ""));
}

void WindowVisual::describe(nlohmann::ordered_json& report) const {
    describe_stale(report, stale_, process_.stale_record());
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

}  // namespace

std::unique_ptr<NodeInstance> open_visual_window(const VisualSettings& settings, VisualWindowOptions options,
                                                 Sockets& sockets, std::uint64_t instance) {
    return std::make_unique<WindowVisual>(settings, std::move(options), sockets, instance);
}

}  // namespace thimble
