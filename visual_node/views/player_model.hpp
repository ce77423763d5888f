// The player's panel without a screen: a modality starts as soon as its button is pressed, because a player wants to feel it and not to plan it. Where a recorded trial is shown instead, its keys are those of replay_model.hpp.
#pragma once

#include "visual_node/views/commands.hpp"
#include "visual_node/views/replay_model.hpp"
#include "visual_node/views/session_link.hpp"

namespace thimble {

class PlayerModel {
  public:
    PlayerModel(std::uint64_t instance, const SessionLink::Channels& channels)
        : link_(instance, channels, 5) {}
    PlayerModel(const PlayerModel&) = delete;  // its replay refers to its link
    PlayerModel& operator=(const PlayerModel&) = delete;

    void update(SessionTime now) { link_.update(now); }
    void press(SessionTime now, Command command);
    // Asks the session to end.
    void quit(SessionTime now) { link_.ask(now, OrderKind::kQuit); }
    void set_delay(SessionTime now, double delay_s) { link_.ask_delay(now, delay_s); }

    const SessionLink& link() const { return link_; }
    // Of the trial that runs or was asked for.
    Modality modality() const;
    bool help() const { return help_; }
    // The next step, or a warning.
    const char* hint(SessionTime now) const;

    // A recorded trial is shown: then the keys are replay_keys().
    bool replaying() const { return link_.receiver().replay() != nullptr; }
    ReplayModel& replay() { return replay_; }
    std::span<const Key> keys() const { return replaying() ? replay_keys() : player_keys(); }

  private:
    void start(SessionTime now, Modality modality) { link_.ask(now, OrderKind::kStart, modality); }

    SessionLink link_;
    ReplayModel replay_{link_};
    bool help_ = false;
};

}  // namespace thimble
