// visual_node: force in (through netem), picture in (direct), frames to the display, percepts out when a frame has become
// visible, the beep at once; between trials the subject's request to go on, where the protocol allows it.
#pragma once

#include <algorithm>

#include "common/node_process.hpp"
#include "common/stale_record.hpp"
#include "visual_node/display.hpp"
#include "visual_node/person_flows.hpp"
#include "visual_node/visual_node.hpp"

namespace thimble {

class VisualProcess final : public NodeProcess {
  public:
    struct Channels {
        Channel* control = nullptr;
        Channel* force_in = nullptr;     // from slave_sim, through netem
        Channel* scene_in = nullptr;     // from slave_sim, direct: picture and beep
        Channel* percept_out = nullptr;  // to the virtual operator: light and sound, not network
        Channel* hand_out = nullptr;     // to the master, where a person's hand is read here
    };

    // `display` and `hand`, which goes with channels.hand_out, outlive the process.
    VisualProcess(std::uint64_t instance, const VisualSettings& settings, const Channels& channels,
                  Display& display, HandSource* hand = nullptr);
    // Opens its channels.
    VisualProcess(std::uint64_t instance, const VisualSettings& settings, Ports& ports, Display& display,
                  HandSource* hand = nullptr);

    const StaleRecord& stale_record() const { return stale_record_; }

  protected:
    void begin_trial(SessionTime now, const SessionControl& control) override;
    void end_trial(SessionTime now) override {
        stale_record_.end(now);
        node_.end_trial(now);
    }
    void network_changed(SessionTime now, const SessionControl& control) override {
        force_flow_.excuse_silence_until(now + silence_of_change(control));
    }
    bool read_page(SessionTime now, const Page& page) override;
    void work(SessionTime now) override;
    SessionTime next_work() const override {
        const SessionTime shown = std::min(node_.next_frame(), display_->next_shown());
        return std::min(shown, std::min(hand_flow_.next(), go_on_.next()));
    }
    StopRequest wants_stop(SessionTime /*now*/) override {
        if (!display_->take_stop()) return {};
        return {EndReason::kEmergencyStop, "the stop key at the subject's screen"};
    }
    InboundFlow* vital_flow() override { return &force_flow_; }
    void add_counters(FlowCounters& sum) const override;

  private:
    void take_force(SessionTime now);
    void take_scene(SessionTime now);
    void beep(SessionTime now);
    void ask_to_go_on(SessionTime now);

    Channels channels_;
    VisualNode node_;
    Display* display_;
    StalePolicy stale_;
    bool picture_delayed_;
    StaleRecord stale_record_;
    InboundFlow force_flow_{Role::kSlaveSim};
    InboundFlow scene_flow_{Role::kSlaveSim};
    OutboundFlow percept_flow_;
    HandFlow hand_flow_;
    GoOnRequest go_on_;
    std::uint32_t beeped_trial_ = 0;
};

}  // namespace thimble
