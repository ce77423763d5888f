#include "visual_node/window/window_loop.hpp"

#include <algorithm>
#include <cmath>
#include <imgui.h>

#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/shared_values.hpp"
#include "visual_node/window/captions.hpp"
#include "visual_node/window/image.hpp"
#include "visual_node/window/page_view.hpp"
// clang-format off
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
// clang-format on

namespace thimble {
namespace {

// A hand is read at least so often, also from devices that send no events.
constexpr Duration kHandPeriod = std::chrono::milliseconds{2};

}  // namespace

const char* to_string(WindowEnd end) {
    static constexpr std::array kNames{"none", "asked", "closed", "screen_lost"};
    return kNames.at(static_cast<std::size_t>(end));
}

WindowLoop::WindowLoop(const Parts& parts, Duration smoothing, bool one_clock)
    : parts_(parts),
      gui_(*parts.window, parts.pages == nullptr ? std::string() : parts.pages->text()),
      playout_(smoothing),
      times_(one_clock),
      pace_(parts.window->refresh_Hz()),
      page_(parts.pages, parts.display),
      controls_(parts.hand, parts.vibration) {
    beeps_.reserve(64);
}

WindowEnd WindowLoop::run(const std::function<bool()>& stop) {
    while (end_ == WindowEnd::kNone && !stop()) {
        if (!turn()) break;
        wait_until(pace_.next(begun_, swapped_), stop);
    }
    if (end_ == WindowEnd::kNone) end_ = WindowEnd::kAsked;
    if (end_ != WindowEnd::kScreenLost && !screenshot_.empty()) save_screenshot(picture());
    if (end_ != WindowEnd::kAsked) say_end();
    if (end_ != WindowEnd::kAsked && parts_.overlay != nullptr) parts_.overlay->closing(wall_now());
    if (parts_.hand != nullptr) parts_.hand->let_go();
    if (parts_.vibration != nullptr) parts_.vibration->stop();
    if (parts_.display != nullptr) parts_.display->close();
    return end_;
}

// A program that ends with its window says the rest itself.
void WindowLoop::say_end() const {
    const bool ends = parts_.stays_open || parts_.overlay != nullptr;
    spdlog::warn("the window {}{}", end_ == WindowEnd::kClosed ? "was closed" : "has lost its screen",
                 ends ? "" : " and shows nothing more; the program continues");
}

bool WindowLoop::turn() {
    take_events(wall_now(), parts_.window->poll_events());
    if (parts_.stays_open) parts_.window->stay_open();
    if (parts_.window->lost()) {
        end_ = WindowEnd::kScreenLost;
    } else if (parts_.window->should_close() && end_ == WindowEnd::kNone) {
        end_ = WindowEnd::kClosed;
    }
    if (end_ != WindowEnd::kNone) return false;
    return draw(wall_now());
}

void WindowLoop::take_events(SessionTime now, std::span<const WindowEvent> events) {
    for (const WindowEvent& event : events) {
        if (!gui_.wants(event)) handle(event);
    }
    if (!parts_.window->lost() && controls_.read(now)) ask_to_go_on();
    take_mail(now);
    if (parts_.overlay != nullptr) parts_.overlay->tick(now);
}

void WindowLoop::wait_until(SessionTime begin, const std::function<bool()>& stop) {
    const Duration longest = parts_.hand != nullptr ? kHandPeriod : kLongestWait;
    for (SessionTime now = wall_now(); now < begin && !stop() && !parts_.window->lost(); now = wall_now()) {
        take_events(wall_now(), parts_.window->wait_events(std::min(begin - now, longest)));
    }
}

void WindowLoop::take_mail(SessionTime now) {
    if (parts_.display == nullptr) return;
    while (const auto scene = parts_.display->take_scene()) playout_.add(*scene);
    while (const auto page = parts_.display->take_page()) turn_to(*page);
    while (const auto asked = parts_.display->take_beep()) {
        if (parts_.beeper != nullptr) parts_.beeper->beep();
        if (parts_.beep_shown) beep_seen_until_ = now + kBeepSeen;
        beeps_.push_back({*asked, std::max(now, *asked)});
    }
}

// A subject who answers needs the pointer, and holds no needle.
void WindowLoop::turn_to(const Page& page) {
    if (!page_.turn_to(page)) return;
    parts_.window->grab_pointer(false);
    if (parts_.hand != nullptr) parts_.hand->let_go();
}

void WindowLoop::handle(const WindowEvent& event) {
    if (event.kind == WindowEvent::Kind::kKey && event.pressed && page_.take_key(event.key)) return;
    if (event.kind == WindowEvent::Kind::kKey && event.pressed && !event.repeated) handle_key(event);
    if (event.kind == WindowEvent::Kind::kKey && parts_.hand_kind == HandKind::kKeyboard)
        controls_.hold_arrow(event);
    if (event.kind == WindowEvent::Kind::kButton && event.pressed) return handle_button();
    if (parts_.hand == nullptr) return;
    if (event.kind == WindowEvent::Kind::kMotion && parts_.window->pointer_grabbed()) {
        parts_.hand->move(event.y);
    } else if (event.kind == WindowEvent::Kind::kFocus && !event.pressed) {
        controls_.release_arrow();
        parts_.window->grab_pointer(false);
        parts_.hand->let_go();
    }
}

void WindowLoop::handle_button() {
    if (page_.asks()) return;  // beside the answers
    ask_to_go_on();
    if (parts_.hand == nullptr || parts_.hand_kind != HandKind::kMouse) return;
    parts_.window->grab_pointer(true);
    parts_.hand->take_hold();
}

void WindowLoop::ask_to_go_on() {
    if (parts_.subject_goes_on && parts_.display != nullptr && waits_to_go_on(page_.page().kind)) {
        parts_.display->ask_to_go_on();
    }
}

void WindowLoop::handle_key(const WindowEvent& event) {
    switch (event.key) {
        case GLFW_KEY_ESCAPE:
            help_ = false;
            parts_.window->grab_pointer(false);
            if (parts_.hand != nullptr) parts_.hand->let_go();
            return;
        case GLFW_KEY_SLASH:  // "?" on most keyboards, and F1 where it is elsewhere
        case GLFW_KEY_F1:
            help_ = !help_ && parts_.overlay == nullptr;  // an overlay has a list of its own
            return;
        case GLFW_KEY_F2:
            times_shown_ = !times_shown_;
            return;
        case GLFW_KEY_F12:
            shot_asked_ = true;
            return;
        case GLFW_KEY_BACKSPACE:
            if (parts_.display != nullptr) parts_.display->ask_to_stop();
            return;
        case GLFW_KEY_SPACE:
        case GLFW_KEY_ENTER:
        case GLFW_KEY_KP_ENTER:
            return ask_to_go_on();
        case GLFW_KEY_F10:  // a subject does not end the experiment
            if (parts_.hand != nullptr && !parts_.stays_open) parts_.window->ask_to_close();
            return;
        default:
            return;
    }
}

std::string WindowLoop::keys() const {
    std::string text =
        "? or F1   this list\n"
        "F2        times from hand to picture\n"
        "F12       save the picture\n"
        "Backspace EMERGENCY STOP: no force until the stop is released\n"
        "          (in a number field it deletes the number)\n";
    if (parts_.hand != nullptr) {
        text += parts_.hand_kind == HandKind::kKeyboard
                    ? "Down      hold it to push the needle in; Up pulls it out\n"
                    : "click     take the needle; then move down to push it in\n";
        text += "Esc       release the needle\n";
        if (!parts_.stays_open) text += "F10       close the window and end\n";
    }
    if (parts_.subject_goes_on) text += "space     continue, where a page waits\n";
    return text;
}

int WindowLoop::scene_width() const {
    const double taken = parts_.overlay == nullptr ? 0 : parts_.overlay->right_margin(*parts_.window);
    return parts_.window->width() - static_cast<int>(std::lround(taken));
}

bool WindowLoop::draw(SessionTime now) {
    GlWindow& window = *parts_.window;
    begun_ = now;
    window.begin_frame(colours::kBackground);
    const auto scene = scene_at(now);
    const int width = scene_width();
    const bool visible = scene && width > 0 && window.height() > 0;
    if (visible) painter_.paint(*scene, {width, window.height(), window.content_scale()}, window.width());
    gui_.begin();
    draw_captions(now, visible ? scene : std::nullopt);
    gui_.end();
    if (wanted_ != nullptr) *wanted_ = window.read_pixels();
    if (shot_asked_) save_screenshot(window.read_pixels());
    shot_asked_ = false;
    window.end_frame();
    swapped_ = wall_now();
    if (window.lost()) {
        end_ = WindowEnd::kScreenLost;
        return false;
    }
    ++frames_;
    if (!scene) {
        times_.add_empty(begun_, swapped_);
        return true;
    }
    times_.add(*scene, begun_, swapped_);
    parts_.display->presented(*scene, swapped_);
    return true;
}

std::optional<Scene> WindowLoop::scene_at(SessionTime now) {
    auto scene = playout_.at(now);
    stale_ = scene && scene->stale;
    controls_.vibrate(now, scene);
    if (scene && scene->cut_away && hand_is_here()) {
        const HandInput hand = parts_.hand->hand();
        if (hand.engaged) scene->cut_away->position_hand_m = parts_.position_scale * hand.position_hand_m;
    }
    return scene;
}

// Warns of old data: the picture alone does not show that it is old.
void WindowLoop::draw_notices() const {
    std::string text = stale_ ? "no message from the needle: the picture is old" : notice_;
    if (!painter_.cutaway()) return draw_notice(text, scene_width());
    if (text.empty() && page_.shown()) text = page_text().title;
    if (!text.empty()) draw_headline(text, *painter_.cutaway());
}

void WindowLoop::draw_overlay(SessionTime now) {
    OverlayFrame frame{*parts_.window, parts_.display == nullptr ? nullptr : &times_};
    frame.hand_kind = parts_.hand_kind;
    if (hand_is_here()) frame.hand_holds = parts_.hand->hand().engaged;
    parts_.overlay->draw(now, frame);
}

void WindowLoop::draw_captions(SessionTime now, const std::optional<Scene>& scene) {
    if (scene) painter_.draw_over(*scene);
    if (page_.shown()) draw_between_trials();
    if (now < beep_seen_until_) draw_beep(scene_width());
    if (parts_.overlay != nullptr) draw_overlay(now);
    if (times_shown_ && parts_.display != nullptr) draw_times(times_);
    draw_notices();
    if (help_) draw_key_help(keys());
}

// A subject sees nothing of the scene between trials. A player sees how the last one ended, and the headline has a title without text.
void WindowLoop::draw_between_trials() {
    constexpr double kShade = 0.6;
    const double opacity = painter_.cutaway() ? kShade : 1;
    const PageText text = page_text();
    if (!page_.asks()) {
        if (painter_.cutaway() && text.body.empty()) return draw_shade(scene_width(), kShade);
        return draw_page(gui_, text, scene_width(), opacity);
    }
    draw_page(gui_, {}, scene_width(), opacity);
    page_.draw_question(gui_, text.body, scene_width());
}

Image WindowLoop::picture() {
    Image image;
    wanted_ = &image;
    if (end_ != WindowEnd::kScreenLost) {
        take_mail(wall_now());
        draw(wall_now());
    }
    wanted_ = nullptr;
    return image;
}

// A failed screenshot must not stop a trial.
void WindowLoop::save_screenshot(const Image& image) const {
    if (image.rgb.empty()) return;
    const std::filesystem::path path = screenshot_.empty() ? "thimble.png" : screenshot_;
    try {
        write_png(path, image);
        spdlog::info("picture saved: {}", path.string());
    } catch (const Error& error) {
        spdlog::error(error.what());
    }
}

}  // namespace thimble
