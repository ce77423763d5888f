// The main thread's work beside the node's thread: events, frames, sound. It ends on request, when the user closes
// the window, or when the screen is gone. The node goes on, unless a subject's pointer is lost with the screen
// (visual_window.cpp).
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "visual_node/person_flows.hpp"
#include "visual_node/visual_settings.hpp"
#include "visual_node/window/beeper.hpp"
#include "visual_node/window/frame_times.hpp"
#include "visual_node/window/gui_layer.hpp"
#include "visual_node/window/hand_controls.hpp"
#include "visual_node/window/overlay.hpp"
#include "visual_node/window/page_view.hpp"
#include "visual_node/window/playout.hpp"
#include "visual_node/window/scene_painter.hpp"
#include "visual_node/window/window_display.hpp"

namespace thimble {

enum class WindowEnd : std::uint8_t { kNone, kAsked, kClosed, kScreenLost };
const char* to_string(WindowEnd end);

// When a beep was asked for and when its tone began: the device's own latency is not in it.
struct BeepTimes {
    SessionTime asked{}, begun{};
};

class WindowLoop {
  public:
    // All outlive the loop; those that may be null are left out.
    struct Parts {
        GlWindow* window;
        WindowDisplay* display = nullptr;  // null: no scene, only the overlay
        PointerHand* hand = nullptr;       // null: nothing here moves the needle
        Overlay* overlay = nullptr;
        Beeper* beeper = nullptr;
        const PageSet* pages = nullptr;  // null: the program's own words, and no questions
        bool subject_goes_on = false;    // a key or a click ends a page that waits
        // A subject with the pointer: nothing that a subject does closes the window.
        bool stays_open = false;
        Vibration* vibration = nullptr;
        bool beep_shown = false;                // as a bright frame
        HandKind hand_kind = HandKind::kMouse;  // only this one moves the hand, and a gamepad
        double position_scale = kPositionScale;
    };
    // `one_clock`: as in FrameTimes.
    WindowLoop(const Parts& parts, Duration smoothing, bool one_clock);

    // Until `stop` says true (asked several times per frame). Stands in for itself in the log where it ends early.
    WindowEnd run(const std::function<bool()>& stop);
    // Takes events, mail and sound, then draws one frame at once. False: closed or lost, no frame was drawn.
    bool turn();
    // A line for the subject at the top; empty: none.
    void set_notice(const std::string& notice) { notice_ = notice; }
    // The last frame is written here when run() ends, and whenever F12 is pressed.
    void set_screenshot(const std::filesystem::path& path) { screenshot_ = path; }
    // Of the next frame, from before its swap.
    Image picture();

    const FrameTimes& times() const { return times_; }
    const std::vector<BeepTimes>& beeps() const { return beeps_; }
    std::uint64_t frames() const { return frames_; }
    WindowEnd end() const { return end_; }

  private:
    void say_end() const;
    void take_mail(SessionTime now);
    void handle(const WindowEvent& event);
    void handle_key(const WindowEvent& event);
    void handle_button();
    void turn_to(const Page& page);
    void ask_to_go_on();
    void wait_until(SessionTime begin, const std::function<bool()>& stop);
    void take_events(SessionTime now, std::span<const WindowEvent> events);
    bool hand_is_here() const { return parts_.hand != nullptr && parts_.hand_kind != HandKind::kDevice; }
    int scene_width() const;
    bool draw(SessionTime now);
    std::optional<Scene> scene_at(SessionTime now);
    void draw_captions(SessionTime now, const std::optional<Scene>& scene);
    void draw_notices() const;
    void draw_overlay(SessionTime now);
    void draw_between_trials();
    PageText page_text() const { return page_.text(parts_.subject_goes_on, parts_.overlay != nullptr); }
    std::string keys() const;
    void save_screenshot(const Image& image) const;

    Parts parts_;
    GuiLayer gui_;
    ScenePainter painter_;
    Playout playout_;
    FrameTimes times_;
    FramePace pace_;
    PageView page_;
    HandControls controls_;
    std::string notice_;
    std::filesystem::path screenshot_;
    std::vector<BeepTimes> beeps_;
    std::uint64_t frames_ = 0;
    SessionTime begun_{}, swapped_{}, beep_seen_until_{};
    WindowEnd end_ = WindowEnd::kNone;
    Image* wanted_ = nullptr;  // where the next frame is to be copied
    bool stale_ = false;       // the picture is
    bool help_ = false, times_shown_ = false, shot_asked_ = false;
};

}  // namespace thimble
