// import and fit from file to file, as the command line calls them.
#include <algorithm>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/text_file.hpp"
#include "netem/commands/commands.hpp"
#include "netem/formats/jitter_table_file.hpp"
#include "netem/formats/text_lines.hpp"
#include "netem/profiles/profiles.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/netem/formats/capture_writer.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

class ImportCommands : public testing::Test {
  protected:
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    static int run(const std::string& command, std::vector<std::string> arguments) {
        CLI::App app;
        const NetemCommand import = add_import(app), fit = add_fit(app);
        arguments.insert(arguments.begin(), command);
        std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
        app.parse(std::move(arguments));
        return (import.subcommand->parsed() ? import : fit).run();
    }

    static std::string refused(const std::string& command, const std::vector<std::string>& arguments) {
        return refusal([&] { run(command, arguments); }, ExitCode::kUsage);
    }

    TemporaryDirectory folder_;
};

TEST_F(ImportCommands, PingToTraceToProfile) {
    std::string text = "\n";  // pcapng begins with the same byte
    for (int i = 1; i <= 200; ++i) {
        if (i % 50 == 0) continue;
        text += "64 bytes from a: icmp_seq=" + std::to_string(i) +
                " ttl=64 time=" + std::to_string(20 + i % 7) + " ms\n";
    }
    write_text_file(path("ping.txt"), text);
    EXPECT_EQ(run("import", {path("ping.txt"), "--out", path("trace.csv")}), 0);
    EXPECT_THAT(read_whole_file(path("trace.csv")), HasSubstr("time_s,delay_s,loss\n0,0.0105,0\n"));
    EXPECT_EQ(run("fit", {path("trace.csv"), "--out", path("lab.toml"), "--table", path("lab.dist")}), 0);
    const LinkProfile profile = load_profile(path("lab.toml"));
    EXPECT_THAT(profile.source, testing::Contains(HasSubstr("halve `loss` in [up] and [down]")));
    EXPECT_NEAR(to_seconds(profile.up.delay), 0.0115, 0.0002);
    EXPECT_EQ(profile.up, profile.down);
    // Nothing says that the 200th was sent.
    EXPECT_NEAR(stationary_loss(profile.up.loss), 3.0 / 199, 1e-9);
    EXPECT_EQ(find_jitter_table(path("lab.dist"))->deviates().size(), 4096U);
}

TEST_F(ImportCommands, IrttMakesATracePerDirection) {
    write_text_file(path("irtt.json"), R"({"round_trips": [{"lost": "false",
        "timestamps": {"client": {"send": {"wall": 5}}}, "delay": {"rtt": 3000, "send": 2000, "receive": 1000}}]})");
    run("import", {path("irtt.json"), "--out", path("trace.csv")});
    EXPECT_THAT(read_whole_file(path("trace.up.csv")), HasSubstr("0,0.000002,0\n"));
    EXPECT_THAT(read_whole_file(path("trace.down.csv")), HasSubstr("0,0.000001,0\n"));
    run("import", {path("irtt.json"), "--direction", "down", "--out", path("trace.csv")});
    EXPECT_EQ(read_whole_file(path("trace.csv")), read_whole_file(path("trace.down.csv")));
}

TEST_F(ImportCommands, TwoCaptures) {
    test::CaptureWriter sent(1), received(1);
    sent.udp(1'000'000, 1, 2, "x");
    received.udp(3'000'000, 1, 2, "x");
    write_text_file(path("a.pcap"), sent.bytes());
    write_text_file(path("b.pcap"), received.bytes());
    run("import", {path("a.pcap"), path("b.pcap"), "--out", path("trace.csv")});
    EXPECT_THAT(read_whole_file(path("trace.csv")), HasSubstr("\n0,0.002,0\n"));
    for (const char* file : {"a.pcap", "none"})
        EXPECT_THROW(run("import", {path(file), "--out", path("trace.csv")}), Error);
    for (const char* option : {"--direction=up", "--interval-s=2"})
        EXPECT_THAT(refused("import", {path("a.pcap"), path("b.pcap"), option, "--out", path("trace.csv")}),
                    HasSubstr("is read as pcap: leave it out"));
}

// Nothing is written then.
TEST_F(ImportCommands, NoFileThatIsReadIsReplaced) {
    const std::string ping = "64 bytes from a: icmp_seq=1 ttl=64 time=20 ms\n",
                      irtt = R"({"round_trips": []})";
    write_text_file(path("ping.txt"), ping);
    write_text_file(path("trace.up.csv"), irtt);
    write_text_file(path("down.csv"), "time_s,delay_s,loss\n0,0.01,0\n");
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"ping.txt", "ping.txt"}, {"trace.up.csv", "trace.csv"}})
        EXPECT_THAT(refused("import", {path(words[0]), "--out", (folder_ / "." / words[1]).string()}),
                    HasSubstr("is named twice"));
    EXPECT_EQ(read_whole_file(path("ping.txt")) + read_whole_file(path("trace.up.csv")), ping + irtt);
    for (const std::vector<std::string>& words : {std::vector<std::string>{"--out", path("down.csv")},
                                                  {"--table", path("down.csv")},
                                                  {"--out", path("new"), "--table", path("./new")}}) {
        std::vector<std::string> fit{path("trace.up.csv"), "--down", path("down.csv")};
        fit.insert(fit.end(), words.begin(), words.end());
        EXPECT_THAT(refused("fit", fit), HasSubstr("is named twice"));
    }
    EXPECT_THAT(refused("import", {path("ping.txt"), "--least-delay-s", "0", "--out", path("trace.csv")}),
                HasSubstr("--least-delay-s is for pcap only"));
}

}  // namespace
}  // namespace thimble
