// docs/pictures/play-*.png: each state of the player's window. With THIMBLE_WRITE_PICTURES set they are made anew.
#include <filesystem>

#include <gtest/gtest.h>

#include "common/runtime/wall_clock.hpp"
#include "tests/unit/views/played_session.hpp"
#include "tests/views/pixels.hpp"
#include "tests/window/virtual_screen.hpp"
#include "visual_node/views/player_panel.hpp"
#include "visual_node/visual_node.hpp"
#include "visual_node/window/window_loop.hpp"

namespace thimble {
namespace {

constexpr double kWall_m = 0.115, kRest_m = 0.02;

struct State {
    const char* name = "";
    Modality modality = Modality::kHF;
    TissuePhase phase = TissuePhase::kFree;
    double needle_m = 0, surface_m = kRest_m, force_N = 0, hand_m = 0;
    bool taken = true, paused = false, help = false;
};

constexpr std::array kStates{
    State{.name = "begin", .taken = false},
    State{.name = "skin",
          .phase = TissuePhase::kContact,
          .needle_m = 0.030,
          .surface_m = 0.030,
          .force_N = 1.4,
          .hand_m = 0.032},
    State{.name = "shaking",
          .phase = TissuePhase::kPenetrated,
          .needle_m = 0.128,
          .force_N = 9,
          .hand_m = 0.09},
    State{.name = "fingertip",
          .modality = Modality::kCF,
          .phase = TissuePhase::kPenetrated,
          .needle_m = 0.1165,
          .force_N = 3.2,
          .hand_m = 0.12},
    State{.name = "other-hand",
          .modality = Modality::kCCF,
          .phase = TissuePhase::kPenetrated,
          .needle_m = 0.1165,
          .force_N = 3.2,
          .hand_m = 0.12},
    State{.name = "bar",
          .modality = Modality::kVF,
          .phase = TissuePhase::kPenetrated,
          .needle_m = 0.1165,
          .force_N = 3.2,
          .hand_m = 0.12},
    State{.name = "paused", .needle_m = 0.005, .paused = true},
    State{.name = "keys", .taken = false, .help = true},
};

// The panel over a window of its own, and a session that says the state.
class PanelOnly final : public Overlay {
  public:
    explicit PanelOnly(const State& state) : panel_(5, session_.channels()) {
        Monitor& m = session_.monitor;
        m.state = state.paused ? NodeState::kIdle : NodeState::kRunning;
        m.modality = state.modality;
        m.phase = state.phase;
        m.position_needle_m = state.needle_m;
        m.position_surface_m = state.surface_m;
        m.position_fixture_m = kWall_m;
        m.network_delay_s = 0.05;
        m.round_trip_s = 0.0502;
        m.paused = state.paused;
        if (state.help) panel_.press(wall_now(), Command::kHelp);
    }
    void tick(SessionTime now) override {
        session_.say(now);
        panel_.tick(now);
    }
    void draw(SessionTime now, const OverlayFrame& frame) override { panel_.draw(now, frame); }
    double right_margin(const GlWindow& window) const override {
        return PlayerPanel::place(window.width(), window.height(), window.content_scale()).width;
    }

  private:
    PlayedViewSession session_;
    PlayerPanel panel_;
};

Scene scene_of(const State& state) {
    VisualNode node(VisualSettings{.fingertip = true, .cut_away = true});
    node.start_trial(from_nanoseconds(1), {.fixture_position_m = kWall_m, .modality = state.modality}, 1);
    node.on_picture(node.next_frame(), {.position_surface_m = kRest_m});
    const ForceFeedback feedback{.position_needle_m = state.needle_m,
                                 .position_surface_m = state.surface_m,
                                 .force_tissue_N = -state.force_N,
                                 .force_total_N = -state.force_N,
                                 .phase = state.phase};
    node.on_picture(node.next_frame(), feedback);
    node.on_force(node.next_frame(), feedback);
    return node.frame(node.next_frame()).value();
}

class PlayPictures : public OnAScreen {
  protected:
    static Image picture(const State& state) {
        GlWindow window({.width = 800,
                         .height = 500,
                         .vsync = false,
                         .scale_from_width = 1150,
                         .scale_from_height = 700});
        WindowDisplay display(Duration::zero());
        PointerHand hand(1);
        if (state.taken) hand.take_hold();
        hand.move(state.hand_m / kPositionScale);
        PanelOnly panel(state);
        WindowLoop loop({&window, &display, &hand, &panel}, Duration::zero(), true);
        display.draw(wall_now(), scene_of(state));
        display.turn_page(wall_now(), {.kind = state.paused ? PageKind::kPaused : PageKind::kNone});
        for (int i = 0; i < 4; ++i) loop.turn();
        return loop.picture();
    }
};

TEST_F(PlayPictures, AreWhatIsDrawn) {
    for (const State& state : kStates) {
        const Image image = picture(state);
        const auto path = std::filesystem::path(THIMBLE_SOURCE_DIR) / "docs/pictures" /
                          (std::string("play-") + state.name + ".png");
        if (std::getenv("THIMBLE_WRITE_PICTURES") != nullptr) write_png(path, image);
        const Image kept = read_png(path);
        ASSERT_EQ(kept.rgb.size(), image.rgb.size()) << state.name;
        const Rect whole{0, 0, static_cast<double>(image.width), static_cast<double>(image.height)};
        EXPECT_LT(count_different(image, kept, whole), image.width * image.height / 100) << state.name;
        EXPECT_LT(std::filesystem::file_size(path), 150'000U) << state.name;
    }
}

}  // namespace
}  // namespace thimble
