// thimble-visual with its window, as a program.
#include <csignal>
#include <cstdlib>
#include <optional>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/loopback/programs.hpp"
#include "tests/loopback/workbench.hpp"
#include "tests/window/virtual_screen.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

constexpr const char* kProgram = THIMBLE_BIN_DIR "/thimble-visual";

bool wait_for_words(const std::filesystem::path& log, const std::string& words) {
    return wait_until([&] { return read_text(log).find(words) != std::string::npos; }, kPatience);
}

TEST(WindowProgram, RefusesToStartWithoutScreen) {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    const Folder folder;
    const PortBlock ports;
    Child visual(kProgram, {"--window", "--base-port", std::to_string(ports.base())}, folder / "log");
    EXPECT_EQ(visual.wait(kPatience), 2);
    EXPECT_THAT(read_text(folder / "log"), HasSubstr("no screen: DISPLAY and WAYLAND_DISPLAY are not set"));
}

class WindowProgramOnAScreen : public OnAScreen {
  protected:
    // Until the program has drawn so many frames: each F12 saves the next one to --screenshot.
    bool draws(int frames) {
        if (!screen_->wait_for_window("Thimble")) return false;
        for (int frame = 1; frame <= frames; ++frame) {
            if (!screen_->press("F12") || !wait_until([&] { return count_saved() >= frame; })) return false;
        }
        return true;
    }
    std::string picture() const { return (screen_->folder() / "last.png").string(); }

  private:
    int count_saved() const {
        const std::string words = read_text(screen_->folder() / "log"), saved = "picture saved";
        int count = 0;
        for (auto at = words.find(saved); at != std::string::npos; at = words.find(saved, at + 1)) ++count;
        return count;
    }
};

TEST_F(WindowProgramOnAScreen, ReportsItsFramesAndEndsBySignal) {
    const auto report = screen_->folder() / "report.json";
    const PortBlock ports;
    Child visual(kProgram,
                 {"--role", "player", "--base-port", std::to_string(ports.base()), "--report", report,
                  "--screenshot", picture()},
                 screen_->folder() / "log");
    ASSERT_TRUE(wait_for_words(screen_->folder() / "log", "ready"));
    ASSERT_TRUE(draws(3)) << visual.last_lines();
    visual.signal(SIGTERM);
    ASSERT_EQ(visual.wait(kPatience), 0) << visual.last_lines();
    const auto json = nlohmann::json::parse(read_text(report));
    EXPECT_EQ(json["window"]["end"], "asked");
    EXPECT_GT(json["window"]["frames"], 2);
    EXPECT_EQ(json["window"]["hand_to_swap"]["count"], 0);  // no trial
}

// The node calls its session, which is not there, ten times a second at most.
bool goes_on(UdpChannel& session) {
    while (!session.receive().empty()) continue;
    int calls = 0;
    return wait_until([&] {
        while (!session.receive().empty()) ++calls;
        return calls >= 4;
    });
}

TEST_F(WindowProgramOnAScreen, OutlivesItsScreen) {
    const auto report = screen_->folder() / "report.json";
    const PortBlock ports;
    const auto session = listen_at(ports.base() + static_cast<unsigned>(Port::kSessionVisual));
    Child visual(kProgram,
                 {"--window", "--base-port", std::to_string(ports.base()), "--report", report, "--screenshot",
                  picture()},
                 screen_->folder() / "log");
    ASSERT_TRUE(wait_for_words(screen_->folder() / "log", "ready"));
    ASSERT_TRUE(draws(1)) << visual.last_lines();
    screen_->kill();
    EXPECT_TRUE(wait_for_words(screen_->folder() / "log", "the program continues"));
    EXPECT_TRUE(goes_on(*session)) << "it has ended: " << visual.last_lines();
    EXPECT_FALSE(visual.poll()) << "it has ended: " << visual.last_lines();
    visual.signal(SIGTERM);
    EXPECT_EQ(visual.wait(kPatience), 0) << visual.last_lines();
    EXPECT_EQ(nlohmann::json::parse(read_text(report))["window"]["end"], "screen_lost");
}

// A session under a lab key, and the stop key at the window of this role: everything stops, and says who it was.
void expect_stop_by(const std::string& role, const std::string& words, VirtualScreen& screen) {
    const Folder folder;
    const PortBlock ports;
    const std::string port = std::to_string(ports.base());
    const bool experimenter = role == "experimenter";
    const auto session = folder.write(
        "session.toml",
        "[session]\nmodalities = ['HF']\ndelays_s = [0.0]\n[trial]\ncontact_hold_s = 40\n"
        "peer_wait_s = 60\n[visual]\ndisplay = '" +
            std::string(experimenter ? "recording" : "window") + "'\n" + under_lab_key(folder / "lab.key"));
    install_programs(folder / "bin");
    if (role == "player")
        replace_program(folder / "bin/thimble-visual",
                        std::string("exec ") + kProgram + " --role player \"$@\"");
    Child run(folder / "bin/thimble",
              {"run", session, "--monitor", "--out", folder / "out", "--base-port", port}, folder / "log");
    ASSERT_TRUE(wait_for_words(folder / "out/trajectories/trial01_HF_0ms.csv", "\n0.2")) << run.last_lines();
    std::optional<Child> view;
    if (experimenter)
        view.emplace(kProgram, std::vector<std::string>{"--role", role, session, "--base-port", port},
                     folder / "view");
    ASSERT_TRUE(screen.wait_for_window(experimenter ? "Thimble, experimenter" : "Thimble"));
    ASSERT_TRUE(screen.press("BackSpace"));
    EXPECT_EQ(run.wait(kPatience), 1) << run.last_lines();
    EXPECT_THAT(read_text(folder / "log"), HasSubstr(words));
    EXPECT_THAT(read_text(folder / "out/trials.csv"), HasSubstr("emergency_stop"));
    const auto report = nlohmann::json::parse(read_text(folder / "out/nodes/thimble-visual_0ms.json"));
    EXPECT_EQ(report["security"]["mode"], "lab-key");
    if (experimenter) return;
    EXPECT_EQ(report["window"]["end"], "asked");
}

TEST_F(WindowProgramOnAScreen, ItsStopKeyStopsASessionUnderALabKey) {
    expect_stop_by("subject", "the stop key at the subject's screen", *screen_);
    expect_stop_by("player", "the stop key at the subject's screen", *screen_);
    expect_stop_by("experimenter", "the stop key in the experimenter's view", *screen_);
}

}  // namespace
}  // namespace thimble
