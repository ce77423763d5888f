// The player's panel without a screen: a modality that is pressed starts at once, because somebody who plays wants to feel
// it and not to plan it.
#pragma once

#include "visual_node/views/commands.hpp"
#include "visual_node/views/session_link.hpp"

namespace thimble {

class PlayerModel {
  public:
    PlayerModel(std::uint64_t instance, const SessionLink::Channels& channels)
        : link_(instance, channels, 5) {}

    void update(SessionTime now) { link_.update(now); }
    void press(SessionTime now, Command command);
    // Asks the session to end.
    void quit(SessionTime now) { ask(now, OrderKind::kQuit, modality()); }
    void set_delay(SessionTime now, double delay_s) { link_.ask_delay(now, delay_s); }

    const SessionLink& link() const { return link_; }
    // Of the trial that runs or was asked for.
    Modality modality() const;
    bool help() const { return help_; }
    // What to do now, or what to look out for.
    const char* hint(SessionTime now) const;

  private:
    void ask(SessionTime now, OrderKind kind, Modality modality);
    void start(SessionTime now, Modality modality) { ask(now, OrderKind::kStart, modality); }

    SessionLink link_;
    bool help_ = false;
};

}  // namespace thimble
