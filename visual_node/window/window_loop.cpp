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
#include "visual_node/window/question_panel.hpp"
// clang-format off
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
// clang-format on

namespace thimble {
namespace {

// A hand is read at least so often, also from devices that send no events.
constexpr Duration kHandPeriod = std::chrono::milliseconds{2};
constexpr Duration kLongestWait = std::chrono::milliseconds{10};

std::string text_of(const char* text) { return text == nullptr || *text == '\0' ? "gamepad" : text; }

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
      pace_(parts.window->refresh_Hz()) {
    beeps_.reserve(64);
    if (parts.pages != nullptr) questions_ = parts.pages->shown();
}

WindowEnd WindowLoop::run(const std::function<bool()>& stop) {
    while (end_ == WindowEnd::kNone && !stop()) {
        if (!turn()) break;
        wait_until(pace_.next(begun_, swapped_), stop);
    }
    if (end_ == WindowEnd::kNone) end_ = WindowEnd::kAsked;
    if (end_ == WindowEnd::kAsked && !screenshot_.empty()) save_screenshot(picture());
    if (end_ == WindowEnd::kScreenLost) {
        spdlog::warn(parts_.stays_open
                         ? "the window's screen is gone"
                         : "the window's screen is gone: nothing is shown any more, the node goes on");
    } else if (end_ == WindowEnd::kClosed) {
        spdlog::warn("the window was closed: nothing is shown any more, the node goes on");
    }
    if (end_ != WindowEnd::kAsked && parts_.overlay != nullptr) parts_.overlay->closing(wall_now());
    if (parts_.hand != nullptr) parts_.hand->let_go();
    if (parts_.vibration != nullptr) parts_.vibration->stop();
    if (parts_.display != nullptr) parts_.display->close();
    return end_;
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
    if (parts_.hand != nullptr) {
        read_gamepad(now);
        push_by_arrows(now);
    }
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
    const bool question = page.kind == PageKind::kQuestion;
    const bool asks = question && page.trial >= 1 && page.trial <= questions_.size();
    if (question && !asks && !(page == page_)) spdlog::warn(unknown_question(page).body);
    page_ = page;
    form_.show(page.trial, asks ? &questions_[page.trial - 1].question : nullptr);
    if (!asks) return;
    parts_.window->grab_pointer(false);
    if (parts_.hand != nullptr) parts_.hand->let_go();
}

void WindowLoop::handle(const WindowEvent& event) {
    if (event.kind == WindowEvent::Kind::kKey && event.pressed && answer_key(event.key)) return;
    if (event.kind == WindowEvent::Kind::kKey && event.pressed && !event.repeated) handle_key(event);
    if (event.kind == WindowEvent::Kind::kKey && parts_.keyboard) hold_arrow(event);
    if (event.kind == WindowEvent::Kind::kButton && event.pressed) return handle_button();
    if (parts_.hand == nullptr) return;
    if (event.kind == WindowEvent::Kind::kMotion && parts_.window->pointer_grabbed()) {
        parts_.hand->move(event.y);
    } else if (event.kind == WindowEvent::Kind::kFocus && !event.pressed) {
        arrow_ = 0;
        parts_.window->grab_pointer(false);
        parts_.hand->let_go();
    }
}

void WindowLoop::handle_button() {
    if (form_.question() != nullptr) return;  // beside the answers
    ask_to_go_on();
    if (parts_.hand == nullptr || parts_.keyboard) return;
    parts_.window->grab_pointer(true);
    parts_.hand->take_hold();
}

// Whether the key was meant for the question that is shown.
bool WindowLoop::answer_key(int key) {
    if (form_.question() == nullptr) return false;
    const bool list = form_.question()->kind == QuestionKind::kChoice;  // it goes downwards
    const bool number = form_.question()->kind == QuestionKind::kNumber;
    if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9) return form_.type(key - GLFW_KEY_0), true;
    if (key >= GLFW_KEY_KP_0 && key <= GLFW_KEY_KP_9) return form_.type(key - GLFW_KEY_KP_0), true;
    switch (key) {
        case GLFW_KEY_LEFT:
        case GLFW_KEY_RIGHT:
            return form_.move(key == GLFW_KEY_RIGHT ? 1 : -1), true;
        case GLFW_KEY_UP:
        case GLFW_KEY_DOWN:
            return form_.move((key == GLFW_KEY_DOWN) == list ? 1 : -1), true;
        case GLFW_KEY_PAGE_UP:
        case GLFW_KEY_PAGE_DOWN:
            return form_.turn_pages(key == GLFW_KEY_PAGE_DOWN ? 1 : -1), true;
        case GLFW_KEY_BACKSPACE:  // a digit too many stops no session; no trial runs, and no force acts
            return number && (form_.clear(), true);
        case GLFW_KEY_DELETE:
            return form_.clear(), true;
        case GLFW_KEY_ENTER:
        case GLFW_KEY_KP_ENTER:
            return give_answer(), true;
        default:
            return false;
    }
}

void WindowLoop::give_answer() {
    const auto given = form_.given();
    if (given && parts_.display != nullptr) parts_.display->answer(*given);
}

// The first press takes the needle; it stays in the hand until Esc.
void WindowLoop::hold_arrow(const WindowEvent& event) {
    if (parts_.hand == nullptr || event.repeated) return;
    const int way = event.key == GLFW_KEY_DOWN ? 1 : event.key == GLFW_KEY_UP ? -1 : 0;
    if (way == 0 || (!event.pressed && way != arrow_)) return;
    arrow_ = event.pressed ? way : 0;
    arrow_since_ = arrow_read_ = event.time;
    if (event.pressed) parts_.hand->take_hold();
}

// A tap moves it a little, a key that is held faster and faster.
void WindowLoop::push_by_arrows(SessionTime now) {
    if (arrow_ == 0) return;
    constexpr double kFirst = 0.2, kMore_per_s = 1.6;
    const double share = kFirst + kMore_per_s * to_seconds(now - arrow_since_);
    parts_.hand->push(arrow_ * std::min(share, 1.0),
                      std::clamp(now - arrow_read_, Duration{0}, kLongestWait));
    arrow_read_ = now;
}

void WindowLoop::ask_to_go_on() {
    if (parts_.subject_goes_on && parts_.display != nullptr && waits_to_go_on(page_.kind)) {
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
        "? or F1   this list\nF2        times from hand to picture\nF12       save the picture\n"
        "Backspace EMERGENCY STOP: no force, until somebody releases it\n"
        "          (where a number is asked for, it clears the number)\n";
    if (parts_.hand != nullptr) {
        text += parts_.keyboard ? "Down      hold it to push the needle in; Up draws it out\n"
                                : "click     take the needle: move down to push it in\n";
        text +=
            "Esc       let go\n"
            "gamepad   hold A, push the left stick down\n";
        if (!parts_.stays_open) text += "F10       close the window and end\n";
    }
    if (parts_.subject_goes_on) text += "space     go on, where a page waits for it\n";
    return text;
}

void WindowLoop::read_gamepad(SessionTime now) {
    if (parts_.window->lost()) return;
    const Duration since =
        stick_read_ == SessionTime{} ? Duration::zero() : std::min(now - stick_read_, kLongestWait);
    stick_read_ = now;
    GLFWgamepadstate state{};
    const bool there = glfwJoystickIsGamepad(GLFW_JOYSTICK_1) == GLFW_TRUE &&
                       glfwGetGamepadState(GLFW_JOYSTICK_1, &state) == GLFW_TRUE;
    if (parts_.vibration != nullptr && there == joystick_.name.empty()) {
        joystick_ = there ? identity_of(text_of(glfwGetJoystickName(GLFW_JOYSTICK_1)),
                                        text_of(glfwGetJoystickGUID(GLFW_JOYSTICK_1)))
                          : JoystickIdentity{};
        parts_.vibration->plugged(joystick_);
    }
    const bool held = there && state.buttons[GLFW_GAMEPAD_BUTTON_A] == GLFW_PRESS;
    if (held != stick_held_) held ? parts_.hand->take_hold() : parts_.hand->let_go();
    if (held && !stick_held_) ask_to_go_on();
    stick_held_ = held;
    if (held) parts_.hand->push(static_cast<double>(state.axes[GLFW_GAMEPAD_AXIS_LEFT_Y]), since);
}

void WindowLoop::vibrate(SessionTime now, const std::optional<Scene>& scene) {
    if (parts_.vibration == nullptr) return;
    parts_.vibration->feel(now, scene ? scene->fingertip_N : 0, scene ? scene->thumb_N : 0);
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
    vibrate(now, scene);
    if (scene && scene->cut_away && parts_.hand != nullptr) {
        const HandInput hand = parts_.hand->hand();
        if (hand.engaged) scene->cut_away->position_hand_m = kPositionScale * hand.position_hand_m;
    }
    return scene;
}

// The picture may be wrong by now, and nothing would show it.
void WindowLoop::draw_notices() const {
    std::string text = stale_ ? "no news from the needle: the picture stands still" : notice_;
    if (!painter_.cutaway()) return draw_notice(text, scene_width());
    if (text.empty() && page_.kind != PageKind::kNone) text = words_of_page().title;
    if (!text.empty()) draw_headline(text, *painter_.cutaway());
}

// A view with a panel says there what to do.
PageText WindowLoop::words_of_page() const {
    static const Instructions kUnchanged;
    const Instructions& words = parts_.pages == nullptr ? kUnchanged : parts_.pages->instructions;
    // The session reads its page set, and this window its own: they may differ.
    if (page_.kind == PageKind::kQuestion && form_.question() == nullptr) return unknown_question(page_);
    PageText text = page_text(page_, words, parts_.subject_goes_on);
    if (parts_.overlay != nullptr && !words.of(page_.kind).body) text.body.clear();
    return text;
}

void WindowLoop::draw_overlay(SessionTime now) {
    OverlayFrame frame{*parts_.window, gui_, parts_.display == nullptr ? nullptr : &times_};
    if (parts_.hand != nullptr) frame.hand_holds = parts_.hand->hand().engaged;
    parts_.overlay->draw(now, frame);
}

void WindowLoop::draw_captions(SessionTime now, const std::optional<Scene>& scene) {
    if (scene) painter_.draw_over(*scene);
    if (page_.kind != PageKind::kNone) draw_between_trials();
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
    const PageText text = words_of_page();
    if (form_.question() == nullptr) {
        if (painter_.cutaway() && text.body.empty()) return draw_shade(scene_width(), kShade);
        return draw_page(gui_, text, scene_width(), opacity);
    }
    draw_page(gui_, {}, scene_width(), opacity);
    if (draw_question(gui_, questions_[page_.trial - 1], form_, text.body, scene_width())) give_answer();
}

Image WindowLoop::picture() {
    Image image;
    wanted_ = &image;
    if (end_ == WindowEnd::kNone || end_ == WindowEnd::kAsked) {
        take_mail(wall_now());
        draw(wall_now());
    }
    wanted_ = nullptr;
    return image;
}

// A picture that cannot be saved is no reason to stop a trial.
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
