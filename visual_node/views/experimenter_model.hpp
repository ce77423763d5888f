// The experimenter's view without a screen: what is asked when something is pressed, and what is shown about it.
#pragma once

#include <cstdint>
#include <optional>

#include "visual_node/views/commands.hpp"
#include "visual_node/views/session_link.hpp"

namespace thimble {

class ExperimenterModel {
  public:
    ExperimenterModel(std::uint64_t instance, const SessionLink::Channels& channels)
        : link_(instance, channels, 10) {}

    void update(SessionTime now);
    void press(SessionTime now, Command command);
    void set_delay(SessionTime now, double delay_s) { link_.ask_delay(now, delay_s); }

    const SessionLink& link() const { return link_; }
    Modality chosen() const { return chosen_; }
    bool help() const { return help_; }
    // The trial about which it is asked whether to exclude it.
    std::optional<std::uint32_t> question() const { return question_; }
    // About the newest repeat or exclusion, which no Monitor shows; empty if there was none.
    TextLine notice() const;

  private:
    void answer(SessionTime now, bool yes);

    SessionLink link_;
    Modality chosen_ = Modality::kHF;
    bool choosing_ = false;  // since the person has chosen, the session's modality is not taken over
    bool help_ = false;
    std::optional<std::uint32_t> question_;
    std::optional<OrderKind> unseen_;  // newest of those that no Monitor shows
};

}  // namespace thimble
