// Both sides of a link test as users start them. The test measures this machine under its present load, so it checks
// only order and wide bounds.
#include <cmath>
#include <csignal>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/network_settings.hpp"
#include "tests/loopback/programs.hpp"

namespace thimble {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;

constexpr unsigned kForce = 11, kNeedle = 14;

struct Result {
    int code = -1;
    std::string words;
    nlohmann::json json;
};

class LinkTest : public testing::Test {
  protected:
    // Without real-time scheduling, so that a test on a busy machine disturbs no other.
    std::filesystem::path session() {
        return folder.write("session.toml", "[runtime]\nrealtime_scheduling = false\n");
    }
    std::string base(unsigned more = 0) const { return std::to_string(ports.base() + more); }

    Child echo(const std::vector<std::string>& more, const std::string& log = "echo",
               const std::string& for_s = "60") {
        Child child(
            built_programs() / "thimble",
            words_in(fmt::format("link-test --listen {} --seconds {}", session().string(), for_s), more),
            folder / log);
        wait_until(
            [&] { return read_text(folder / log).find("ready") != std::string::npos || child.poll(); });
        return child;
    }
    Result test(const std::vector<std::string>& more) {
        return understood(
            run_thimble(words_in("link-test --host 127.0.0.1 --json " + session().string(), more)));
    }
    static Result understood(const Outcome& outcome) {
        Result result{outcome.code, outcome.words, {}};
        const auto start = outcome.words.find('{'), end = outcome.words.rfind('}');
        if (start == std::string::npos || end == std::string::npos) return result;
        result.json = nlohmann::json::parse(outcome.words.substr(start, end + 1 - start), nullptr, false);
        return result;
    }
    Child relay(unsigned offset, const std::vector<std::string>& link) {
        return Child(
            built_programs() / "thimble-netem",
            words_in(fmt::format("--listen 127.0.0.1:{} --to 127.0.0.1:{} --default-scheduling --link",
                                 base(offset), base(far + offset)),
                     link),
            folder / fmt::format("relay{}", offset));
    }

    static constexpr unsigned far = static_cast<unsigned>(Port::kCount);
    Folder folder;
    PortBlock ports;
};

TEST_F(LinkTest, EveryPortOfThisMachineAnswers) {
    Child far_side = echo({"--base-port", base()});
    const Result result = test({"--base-port", base(), "--seconds", "1"});
    ASSERT_THAT(result.code, AnyOf(0, 1)) << result.words;  // 1: this machine stood still
    ASSERT_EQ(result.json["ports"].size(), static_cast<std::size_t>(Port::kCount));
    EXPECT_EQ(result.json["finding"], "");
    for (const auto& port : result.json["ports"]) {
        EXPECT_EQ(port["answer"], "answers");
        EXPECT_TRUE(port["counted_at_the_end"]);
        EXPECT_GT(port["arrived_back"], 0U);
        EXPECT_LE(port["arrived_there"], port["sent"]);
        EXPECT_LE(port["arrived_back"], port["echoed"]);
    }
    EXPECT_EQ(result.json["ports"][kNeedle]["name"], "slave_sim_needle");
    EXPECT_GT(result.json["ports"][kNeedle]["sent"], result.json["ports"][6]["sent"]);
    EXPECT_GT(result.json["largest_datagram_bytes"], 1400U);
    // Both clocks are the same: the truth is 0.
    const auto& clock = result.json["clock"];
    EXPECT_LE(std::abs(clock["offset_s"].get<double>()), clock["bound_s"].get<double>() + 1e-9);
    EXPECT_EQ(clock["steps"], 0U);
    far_side.signal(SIGINT);
    EXPECT_EQ(far_side.wait(kPatience), 0);
    EXPECT_THAT(read_text(folder / "echo"), HasSubstr("0 malformed"));
}

TEST_F(LinkTest, APortTakenByNobodyIsNamed) {
    Child far_side = echo({"--base-port", base(), "--ports", "14,6,14"});
    const Result result = test({"--base-port", base(), "--ports", "6,11,14,11", "--seconds", "0.2"});
    EXPECT_EQ(result.code, 3) << result.words;
    ASSERT_EQ(result.json["ports"].size(), 3U);
    EXPECT_EQ(result.json["ports"][0]["answer"], "answers");
    EXPECT_EQ(result.json["ports"][1]["answer"], "nobody listens");
    EXPECT_EQ(result.json["ports"][2]["answer"], "answers");
    EXPECT_EQ(result.json["modalities"].size(), 4U);  // by the port that does answer
}

TEST_F(LinkTest, WhereNobodyListensItSaysHowToStart) {
    const Result result = test({"--base-port", base()});
    EXPECT_EQ(result.code, 3);
    EXPECT_THAT(result.json["finding"], HasSubstr("thimble link-test --listen --base-port " + base()));
    EXPECT_TRUE(result.json["modalities"].empty());
}

// 30 ms there and 10 ms back, a fifth lost on the way there; the force's port drops all.
TEST_F(LinkTest, DelayLossAndASilentPortThroughTheRelay) {
    Child far_side = echo({"--base-port", base(far), "--ports", "11,14"});
    const Child needle = relay(kNeedle, {"up.delay_s=0.03", "down.delay_s=0.01", "up.loss=0.2"});
    const Child force = relay(kForce, {"loss=1"});
    ASSERT_TRUE(wait_until([&] {
        return read_text(folder / "relay14").find("ready") != std::string::npos &&
               read_text(folder / "relay11").find("ready") != std::string::npos;
    }));
    const Result result = test({"--base-port", base(), "--ports", "11,14", "--seconds", "2"});
    EXPECT_EQ(result.code, 3) << result.words;
    EXPECT_EQ(result.json["ports"][0]["answer"], "silent");
    EXPECT_THAT(result.json["finding"], HasSubstr("a firewall may block them"));
    const auto& port = result.json["ports"][1];
    ASSERT_EQ(port["answer"], "answers") << result.words;
    EXPECT_GE(port["round_trip_median_s"].get<double>(), 0.040);
    EXPECT_THAT(port["loss_there"].get<double>(), AllOf(testing::Gt(0.1), testing::Lt(0.35)));
    EXPECT_LT(port["loss_back"].get<double>(), 0.1);
    // The clocks agree, although the middle of each exchange is 10 ms off. The bound covers that.
    const auto& clock = result.json["clock"];
    EXPECT_GT(clock["offset_s"].get<double>(), 0.008);
    EXPECT_LE(clock["offset_s"].get<double>(), clock["bound_s"].get<double>());
    EXPECT_EQ(result.json["modalities"][0]["verdict"], "does not fit");  // HF, 40 ms
    EXPECT_NE(result.json["modalities"][1]["verdict"], "fits");          // CF, a fifth lost
}

TEST_F(LinkTest, ARoundTripIsNoPause) {
    Child far_side = echo({"--base-port", base(far), "--ports", "14"});
    const Child needle = relay(kNeedle, {"delay_s=0.1"});
    ASSERT_TRUE(wait_until([&] { return read_text(folder / "relay14").find("ready") != std::string::npos; }));
    const auto port = test({"--base-port", base(), "--ports", "14", "--seconds", "1"}).json["ports"][0];
    EXPECT_GE(port["round_trip_median_s"].get<double>(), 0.2);
    EXPECT_LT(port["longest_pause_s"].get<double>(), port["round_trip_median_s"].get<double>());
}

TEST_F(LinkTest, TheEchoEndsByItselfAndItsPortsAreItsOwn) {
    Child first = echo({"--base-port", base()}, "first");
    Child second = echo({"--base-port", base()}, "second");
    EXPECT_EQ(second.wait(kPatience), 3);
    EXPECT_THAT(read_text(folder / "second"), HasSubstr("another program uses that port"));
    first.signal(SIGTERM);
    first.wait(kPatience);
    EXPECT_EQ(echo({"--base-port", base()}, "third", "0.2").wait(kPatience), 0);
}

TEST_F(LinkTest, WhatMakesNoSenseIsRefused) {
    const auto code = [&](const std::vector<std::string>& words) { return run_thimble(words).code; };
    EXPECT_EQ(code({"link-test"}), 2);
    EXPECT_EQ(code({"link-test", "--host", "127.0.0.1", "--listen"}), 2);
    EXPECT_EQ(code({"link-test", "--host", "127.0.0.1", "--ports", "99"}), 2);
    EXPECT_EQ(code({"link-test", "--host", "no.such.host.invalid"}), 3);
}

// In a network namespace of its own, where the test's user may be root.
class LinkTestNamespace : public LinkTest {
  protected:
    void SetUp() override {
        if (run_to_end(
                "/bin/sh",
                {"-c",
                 "unshare -rn sh -c 'PATH=$PATH:/usr/sbin:/sbin; ip link add near type veth peer name away'"})
                .code != 0)
            GTEST_SKIP() << "the kernel or this container has no network namespaces with veth for us, or "
                            "ip(8) is missing (package iproute2)";
    }
    Result inside(const std::string& script) {
        const auto file = folder.write("script", "PATH=$PATH:/usr/sbin:/sbin\n" + script);
        return understood(run_to_end("/bin/sh", {"-c", fmt::format("unshare -rn sh {}", file.string())}));
    }
    // In a script: until the program in the background, whose words are in `far`, says that it listens.
    std::string far_is_ready() const {
        return fmt::format("while kill -0 $far && ! grep -q ready {}; do sleep 0.02; done\n",
                           (folder / "far").string());
    }
    std::string far_words() const { return " >" + (folder / "far").string() + " 2>&1"; }
    std::string command(const std::string& more) {
        return fmt::format("{} link-test {} {}", (built_programs() / "thimble").string(), more,
                           session().string());
    }
};

TEST_F(LinkTestNamespace, TheMtuOfThisMachinesInterface) {
    const Result result = inside(
        fmt::format("ip link set lo mtu 1280 up\n{}{} &\nfar=$!\n{}{}\ncode=$?\nkill $far\nexit $code\n",
                    command("--listen --ports 14"), far_words(), far_is_ready(),
                    command("--host 127.0.0.1 --ports 14 --seconds 0.2 --json 2>/dev/null")));
    ASSERT_FALSE(result.json.is_discarded()) << result.words;
    EXPECT_EQ(result.json["largest_datagram_bytes"], 1280 - 28) << result.words;
    EXPECT_TRUE(result.json["largest_limited_here"]);
}

// The far end of the cable takes less than the near one believes: no error, only silence.
TEST_F(LinkTestNamespace, AnMtuThatIsSmallerOnTheWay) {
    const Result result = inside(fmt::format(
        "unshare -n sh -c 'until ip link set away mtu 1300 up 2>/dev/null; do sleep 0.02; done;"
        " ip addr add 10.77.0.2/24 dev away; exec {}'{} &\nfar=$!\n"
        "ip link add near mtu 1500 type veth peer name away\n"
        "until ip link set away netns $far 2>/dev/null && ! ip link show away >/dev/null 2>&1; do sleep "
        "0.02; "
        "done\n"
        "ip addr add 10.77.0.1/24 dev near\nip link set near up\n{}{}\ncode=$?\nkill $far\nexit "
        "$code\n",
        command("--listen --ports 14"), far_words(), far_is_ready(),
        command("--host 10.77.0.2 --ports 14 --seconds 0.2 --json 2>/dev/null")));
    ASSERT_FALSE(result.json.is_discarded()) << result.words;
    EXPECT_EQ(result.json["largest_datagram_bytes"], 1300 - 28) << result.words;
    EXPECT_FALSE(result.json["largest_limited_here"]);
}

TEST_F(LinkTestNamespace, NoRouteIsSaidAsSuch) {
    const Result result = inside(command("--host 10.9.9.9 --ports 14 --json") + "\n");
    EXPECT_EQ(result.code, 3);
    EXPECT_THAT(result.words, HasSubstr("is there a route to it?"));
}

}  // namespace
}  // namespace thimble
