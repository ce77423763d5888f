// `thimble play` under test: the test plays the window (a scripted hand, in the visual node's name) and the panel
// (orders, in the experimenter's), and watches the Monitor as a panel does. thimble-visual runs with its recording display.
#pragma once

#include <functional>

#include "common/flow.hpp"
#include "common/runtime/sockets.hpp"
#include "session/records/trajectory_file.hpp"
#include "session/records/trial_table.hpp"
#include "tests/loopback/played_view.hpp"
#include "tests/loopback/programs.hpp"

namespace thimble {

class PlayedHand {
  public:
    // --record and ports are the helper's own. The fixture lies 35 mm deep, a contact of half a second beeps.
    explicit PlayedHand(const std::vector<std::string>& arguments, const std::string& more_settings = "");

    // Moves the hand (60 inputs a second) and listens, until `done`; false if patience ended first, or the program did.
    bool play(const std::function<bool()>& done);
    bool play_for(Duration time);

    // Where the hand goes, at 20 mm/s; none: no input at all.
    void go_to(double position_hand_m) { target_m_ = position_hand_m; }
    void leave() { present_ = false; }
    void order(OrderKind kind, double value = 0, Modality modality = Modality::kHF);

    void network(const char* name);

    const Monitor& monitor() const { return view_.monitor(); }
    std::uint32_t trial() const { return view_.trial(); }
    std::uint64_t monitors() const { return view_.heard(); }
    bool running() const { return view_.running(); }

    Child& launcher() { return child_; }
    int end() { return child_.wait(kPatience).value_or(-1); }
    int quit() {
        order(OrderKind::kQuit);
        return end();
    }
    std::uint16_t base_port() const { return ports_.base(); }
    std::filesystem::path out() const { return folder_ / "out"; }
    std::string words() const { return read_text(folder_ / "words"); }
    std::vector<TrialRow> rows() const { return read_trial_table(out() / "trials.csv"); }

  private:
    void tick(SessionTime now);

    Folder folder_;
    PortBlock ports_;
    Sockets sockets_;
    OutboundFlow hand_;
    PlayedView view_;
    Child child_;
    bool present_ = true;
    double target_m_ = 0, wanted_m_ = 0;
    SessionTime next_{};
};

}  // namespace thimble
