// A session in virtual time whose hand is a visitor's pointer, or the virtual operator's. The page advances it by the time that has
// passed between two of its frames. No clock, no window: a test runs it as the page does.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "master/devices/pointer_handle.hpp"
#include "session/virtual/virtual_session.hpp"

namespace thimble {

// The simulated screen, which also keeps the newest picture.
class SeenDisplay final : public Display {
  public:
    explicit SeenDisplay(const VisualSettings& visual) : screen_(visual) {}

    void draw(SessionTime now, const Scene& scene) override {
        newest_ = scene;
        screen_.draw(now, scene);
    }
    std::optional<ShownScene> shown(SessionTime now) override { return screen_.shown(now); }
    SessionTime next_shown() const override { return screen_.next_shown(); }
    void turn_page(SessionTime /*now*/, const Page& /*page*/) override {}
    void beep(SessionTime /*now*/) override { ++beeps_; }
    bool take_go_on() override { return false; }
    std::optional<GivenAnswer> take_answer() override { return std::nullopt; }
    bool take_stop() override { return false; }

    const Scene& newest() const { return newest_; }
    std::uint64_t beeps() const { return beeps_; }

  private:
    RecordingDisplay screen_;
    Scene newest_;
    std::uint64_t beeps_ = 0;
};

struct LiveChoice {
    Modality modality = Modality::kHF;
    double delay_s = 0.05;  // one way, of the force
    bool virtual_hand = false;
    Compensator compensator = Compensator::kNone;
    std::uint64_t seed = 1;
};

// The numbers that the page shows beside the picture. SI units; forces act on the operator, negative resists insertion.
struct LiveState {
    double time_s = 0;  // of the running trial
    double needle_m = 0, surface_m = 0, fixture_m = 0;
    double force_hand_N = 0;    // of the handle, positive pushes the hand out
    double force_finger_N = 0;  // of the fingertip device
    double force_bar_N = 0;     // that the bar shows
    double force_total_N = 0;   // at the needle
    double energy_in_J = 0;    // of the hand on the handle; negative: the loop has given out more than it got
    double contacts_lost = 0;  // of the fixture, in this trial
    double frequency_Hz = 0;   // contacts lost per second, of the last two seconds
    double hold_s = 0;         // unbroken contact with the fixture
    double beeps = 0;          // of this trial
    double trials = 0;         // ended
    double hand_m = 0;         // where the hand wants the needle
    double delay_s = 0;        // of the force path, one way, with a network too
};

class LiveTrial {
  public:
    explicit LiveTrial(const LiveChoice& choice);

    // Where the hand wants the handle, m, and whether it holds on. Holds until the next call.
    void point(double position_hand_m, bool engaged) { hand_ = {position_hand_m, engaged}; }
    // The force path's delay from now on.
    void change_delay(double delay_s);
    // Both ways of a profile that comes with the program. False: none has this name.
    bool change_network(std::string_view name);
    // Advances time. After a trial the next one begins.
    void advance(double seconds);

    LiveState state() const;
    // With the cut-away view's values, undelayed.
    Scene scene() const;
    const VirtualSession& session() const { return *session_; }

  private:
    void start_trial();
    void watch_contact();
    void poke();

    LiveChoice choice_;
    SystemSettings settings_;
    PointerHandle pointer_;
    SeenDisplay display_;
    std::unique_ptr<VirtualSession> session_;
    SessionTime end_{};  // of what has been granted
    HandInput hand_{};
    std::uint32_t trials_ = 0;
    std::uint64_t beeps_before_ = 0;
    bool touching_ = false;
    std::vector<double> lost_at_s_;  // of this trial
};

}  // namespace thimble
