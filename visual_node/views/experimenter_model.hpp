// The experimenter's view without a screen: what is asked when something is pressed, and what is shown about it.
#pragma once

#include <cstdint>
#include <optional>

#include "visual_node/display.hpp"
#include "visual_node/views/commands.hpp"
#include "visual_node/views/session_link.hpp"

namespace thimble {

class ExperimenterModel {
  public:
    ExperimenterModel(std::uint64_t instance, const SessionLink::Channels& channels)
        : link_(instance, channels, 10) {}

    void update(SessionTime now) {
        link_.update(now);
        find_rest();
        if (!choosing_ && link_.receiver().heard()) chosen_ = link_.monitor().modality;
    }

    void press(SessionTime now, Command command) {
        const std::uint32_t trial = link_.receiver().trial();
        if (const auto modality = modality_of(command)) {
            chosen_ = *modality;
            choosing_ = true;
            return;
        }
        if (link_.take(now, command)) return;
        switch (command) {
            case Command::kStart:
                return link_.ask(now, OrderKind::kStart, chosen_);
            case Command::kRepeat:
                if (trial == 0) return;
                unseen_ = OrderKind::kRepeat;
                return link_.ask(now, OrderKind::kRepeat);
            case Command::kExclude:
                if (trial != 0) question_ = trial;
                return;
            case Command::kYes:
                return answer(now, true);
            case Command::kNo:
                return answer(now, false);
            case Command::kHelp:
                help_ = !help_;
                return;
            default:
                return;
        }
    }

    void set_delay(SessionTime now, double delay_s) { link_.ask_delay(now, delay_s); }

    const SessionLink& link() const { return link_; }
    // Of the newest Monitor; nothing before there is one.
    std::optional<Scene> scene() const {
        if (!link_.receiver().heard()) return std::nullopt;
        const Monitor& m = link_.monitor();
        Scene scene;
        scene.position_needle_m = m.position_needle_m;
        scene.position_surface_m = m.position_surface_m;
        scene.position_surface_rest_m = rest_m_;
        scene.set_cut_away({m.position_needle_m, m.position_fixture_m, m.force_tissue_N, m.force_fixture_N,
                            std::nullopt, m.phase, m.modality, m.fixture_present},
                           m.force_total_N);
        return scene;
    }
    Modality chosen() const { return chosen_; }
    bool help() const { return help_; }
    // The trial about which it is asked whether to exclude it.
    std::optional<std::uint32_t> question() const { return question_; }
    // About the newest repeat or exclusion, which no Monitor shows; empty if there was none.
    TextLine notice() const {
        if (!unseen_) return {};
        const OrderSender& orders = link_.orders();
        const bool sent = orders.progress(*unseen_) == OrderProgress::kSent;
        return TextLine::of("{} of trial {}: {}", to_string(*unseen_), orders.asked(*unseen_).trial,
                            sent ? "sent, see the session's log for the answer" : "being sent");
    }

  private:
    // Rest position of the surface. A view that starts later takes the first one it sees.
    void find_rest() {
        const Monitor& m = link_.monitor();
        const std::uint32_t trial = link_.receiver().trial();
        if (m.phase == TissuePhase::kFree || trial != rest_of_) rest_m_ = m.position_surface_m;
        rest_of_ = trial;
        rest_m_ = std::min(rest_m_, m.position_surface_m);
    }

    void answer(SessionTime now, bool yes) {
        if (yes && question_) {
            Order order;
            order.kind = OrderKind::kExclude;
            order.trial = *question_;  // the trial shown may be the next one by now
            link_.ask(now, order);
            unseen_ = OrderKind::kExclude;
        }
        question_.reset();
    }

    SessionLink link_;
    double rest_m_ = 0;
    std::uint32_t rest_of_ = 0;  // trial
    Modality chosen_ = Modality::kHF;
    bool choosing_ = false;  // since the person has chosen, the session's modality is not taken over
    bool help_ = false;
    std::optional<std::uint32_t> question_;
    std::optional<OrderKind> unseen_;  // newest of those that no Monitor shows
};

}  // namespace thimble
