// The player's panel without a screen.
#pragma once

#include "visual_node/person_flows.hpp"
#include "visual_node/views/commands.hpp"
#include "visual_node/views/session_link.hpp"
#include "visual_node/views/view_layout.hpp"

namespace thimble {

// A recorded trial: what is asked when something is pressed or the scrub bar is dragged.
class ReplayModel {
  public:
    // The link outlives the model. All below makes sense while its receiver has a replay().
    explicit ReplayModel(SessionLink& link) : link_(&link) {}

    void press(SessionTime now, Command command);
    void seek(SessionTime now, double time_s);  // taken to the nearest of the trial

    // The last order until the replay shows its effect, then the replay's state.
    double position_s() const;
    bool paused() const;
    double speed() const;
    const ReplayState& state() const;

  private:
    void play_or_pause(SessionTime now);
    void stop_and_step(SessionTime now, double step_s);
    bool asking(OrderKind kind) const { return link_->orders().progress(kind) == OrderProgress::kAsking; }

    SessionLink* link_;
};

// Between times of a trial and pixels of its scrub bar.
struct ScrubScale {
    Rect bar;
    double duration_s = 0;

    double x(double time_s) const;
    double time_s(double x) const;  // taken to the nearest of the trial
};

// The next thing for the player to do. From kApproach on in the order of a trial.
enum class PlayerStep : std::uint8_t {
    kStart,
    kPaused,
    kNeedleHeld,
    kTake,
    kApproach,
    kPress,
    kInside,
    kStay,
    kShaking,
    kWithdraw,
};

// A later step shows at once, an earlier one of the same trial after it has held for kSettle. So an oscillation, which passes the
// fixture many times a second, does not make the hint flip.
class SteadyStep {
  public:
    static constexpr Duration kSettle = std::chrono::milliseconds{1200};

    void update(SessionTime now, PlayerStep step) {
        const bool back = step >= PlayerStep::kApproach && step < shown_;
        if (!back) shown_ = step;
        if (!back || step > newest_back_) back_since_ = now;
        newest_back_ = back ? step : PlayerStep::kStart;
        if (back && now - back_since_ >= kSettle) shown_ = step;
    }
    PlayerStep shown() const { return shown_; }

  private:
    PlayerStep shown_ = PlayerStep::kStart, newest_back_ = PlayerStep::kStart;
    SessionTime back_since_{};
};

// A modality starts as soon as its button is pressed, because a player wants to feel it and not to plan it. Where a recorded trial
// is shown instead, its keys are those of ReplayModel.
class PlayerModel {
  public:
    PlayerModel(std::uint64_t instance, const SessionLink::Channels& channels)
        : link_(instance, channels, 5) {}
    PlayerModel(const PlayerModel&) = delete;  // its replay refers to its link
    PlayerModel& operator=(const PlayerModel&) = delete;

    void update(SessionTime now) {
        link_.update(now);
        step_.update(now, step(now));
    }
    void press(SessionTime now, Command command);
    // Asks the session to end.
    void quit(SessionTime now) { link_.ask(now, OrderKind::kQuit); }
    void set_delay(SessionTime now, double delay_s) { link_.ask_delay(now, delay_s); }

    const SessionLink& link() const { return link_; }
    // Of the trial that runs or was asked for.
    Modality modality() const;
    bool help() const { return help_; }
    // Whether a hand at the window has the needle; nothing where none ever does.
    void set_hand(std::optional<bool> holds, HandKind kind = HandKind::kMouse) {
        hand_holds_ = holds;
        hand_kind_ = kind;
    }
    // One sentence: what to do next.
    const char* hint() const;

    // A recorded trial is shown: then the keys are replay_keys().
    bool replaying() const { return link_.receiver().replay() != nullptr; }
    ReplayModel& replay() { return replay_; }
    std::span<const Key> keys() const { return replaying() ? replay_keys() : player_keys(); }

  private:
    void start(SessionTime now, Modality modality) { link_.ask(now, OrderKind::kStart, modality); }

    PlayerStep step(SessionTime now) const;

    SessionLink link_;
    ReplayModel replay_{link_};
    SteadyStep step_;
    std::optional<bool> hand_holds_;
    HandKind hand_kind_ = HandKind::kMouse;
    bool help_ = false;
};

}  // namespace thimble
