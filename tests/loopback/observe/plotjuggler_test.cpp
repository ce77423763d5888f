// `thimble run --plotjuggler`: heard by Python, which is not Thimble's.
#include <cstdlib>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "session/observe/observers.hpp"
#include "tests/loopback/real_run.hpp"

namespace thimble {
namespace {

using testing::Contains;
using testing::HasSubstr;

bool has_python() { return std::system("python3 -c 'import json, socket' > /dev/null 2>&1") == 0; }

// The output of hear_plotjuggler.py for a run with such a session.
nlohmann::json heard_of(SessionFile session) {
    const Folder folder;
    Child listener(
        "/bin/sh",
        {"-c", "exec python3 '" THIMBLE_SOURCE_DIR "/tests/loopback/observe/hear_plotjuggler.py' '" +
                   (folder / "port").string() + "' 15 " + std::to_string(session.parallel_conditions)},
        folder / "heard");
    if (!wait_until([&] { return std::filesystem::exists(folder / "port"); }))
        throw std::runtime_error(read_text(folder / "heard"));
    session.contact_hold_s = kEndlessHold_s;
    RealRun run(session, {"--plotjuggler", read_text(folder / "port")});
    EXPECT_EQ(listener.wait(kPatience), 0) << read_text(folder / "heard") << run.words();
    run.launcher().signal(SIGTERM);
    run.end();
    return nlohmann::json::parse(read_text(folder / "heard"));
}

TEST(PlotJuggler, APythonProgramHearsTheSession) {
    if (!has_python()) GTEST_SKIP() << "there is no python3 with its standard library";
    const auto conditions = heard_of({});
    ASSERT_EQ(conditions.size(), 1U) << conditions;
    const auto heard = conditions.at("");  // alone it has no name
    for (const char* key :
         {"force_total_N", "position_surface_m", "network_delay_s", "tissue_phase", "trial"})
        EXPECT_THAT(heard["keys"], Contains(key));
    EXPECT_GT(heard["moved_m"], 0.01);
    EXPECT_LT(heard["per_second"], 250);  // twice the 100 Hz, for a loop that was late
    EXPECT_EQ(heard["times_go_up"], true);
    EXPECT_LT(heard["behind_s"], 60);  // a date, not a machine's own time
    EXPECT_GT(heard["behind_s"], -60);
    EXPECT_EQ(heard["last"]["modality"], "HF");
}

// Else both delays were drawn as one curve that jumps to and fro.
TEST(PlotJuggler, LanesSideBySideHaveNames) {
    if (!has_python()) GTEST_SKIP() << "there is no python3 with its standard library";
    SessionFile session;
    session.delays_s = "[0.0, 0.0025]";
    session.parallel_conditions = 2;
    const auto conditions = heard_of(session);
    ASSERT_EQ(conditions.size(), 2U) << conditions;
    for (const char* condition : {"0ms", "2.5ms"}) {
        EXPECT_EQ(conditions.at(condition).at("times_go_up"), true) << condition;
    }
    EXPECT_LT(conditions["0ms"]["last"]["network_delay_s"], conditions["2.5ms"]["last"]["network_delay_s"]);
}

TEST(PlotJuggler, AnotherMachineIsRefusedByName) {
    const Folder folder;
    const auto session = folder.write("session.toml", SessionFile{}.text()).string();
    const Outcome refused =
        run_thimble({"run", session, "--out", (folder / "out").string(), "--plotjuggler", "192.0.2.1:9870"});
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.words, HasSubstr("--plotjuggler: '192.0.2.1' is not this machine alone"));
}

TEST(Observers, AreReadFromText) {
    EXPECT_EQ(read_observer("9870", "--to").host, "127.0.0.1");
    EXPECT_EQ(read_observer("lab:65535", "--to").port, 65535);
    for (const char* wrong : {"", "lab", "lab:", ":1", "lab:65536", "lab:-1", "1 "})
        EXPECT_THROW(read_observer(wrong, "--to"), Error) << wrong;
}

}  // namespace
}  // namespace thimble
