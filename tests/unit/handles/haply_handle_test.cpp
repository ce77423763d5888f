// Haply's Inverse3 behind a service that behaves, is slow, silent, gone, or hostile.
#include "master/devices/haply/haply_handle.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/messages.hpp"
#include "common/random.hpp"
#include "tests/devices/mock_haply.hpp"
#include "tests/unit/handles/live_handle.hpp"

namespace thimble {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

HaplySettings at_port(const MockHaply& service) {
    HaplySettings settings;
    settings.port = service.port();
    return settings;
}
std::unique_ptr<Handle> open(const HaplySettings& settings) {
    return open_haply(settings, 3, {.realtime_scheduling = false});
}
std::string why_not(const HaplySettings& settings) {
    return refusal([&] { open(settings); }, ExitCode::kUsage);
}

constexpr const char* kGood =
    R"({"inverse3":[{"device_id":"A1","state":{"cursor_position":{"x":0.1,"y":-0.2,"z":0}}}]})";

TEST(HaplyMessage, OnlyAStateOfTheDeviceIsOne) {
    const HaplyReading good = read_haply_state(kGood, "A1");
    ASSERT_TRUE(good.state);
    EXPECT_THAT(good.state->position_m, ElementsAre(0.1, -0.2, 0));
    EXPECT_TRUE(good.state->calibrated);
    EXPECT_THAT(read_haply_state(kGood, "A2").trouble, HasSubstr("no longer lists the device"));
    for (const char* bad :
         {"", "{", "[]", "null", "{\"inverse3\":{}}", "{\"inverse3\":[]}", "{\"inverse3\":[3]}",
          R"({"inverse3":[{"device_id":"A1"}]})", R"({"inverse3":[{"device_id":7}]})",
          R"({"inverse3":[{"device_id":"A1","state":{"cursor_position":[1,2,3]}}]})",
          R"({"inverse3":[{"device_id":"A1","state":{"cursor_position":{"x":0,"y":"0","z":0}}}]})",
          R"({"inverse3":[{"device_id":"A1","state":{"cursor_position":{"x":0,"y":null,"z":0}}}]})",
          R"({"inverse3":[{"device_id":"A1","state":{"cursor_position":{"x":0,"y":1e999,"z":0}}}]})",
          R"({"inverse3":[{"device_id":"A1","state":{"cursor_position":{"x":0,"y":0.6,"z":0}}}]})"}) {
        const HaplyReading reading = read_haply_state(bad, "A1");
        EXPECT_FALSE(reading.state) << bad;
        EXPECT_FALSE(reading.trouble.empty()) << bad;
    }
}

// Cut short at each byte, and with bytes changed: a state or a reason, never more than a hand reaches.
TEST(HaplyMessage, DamagedMessagesAreRefusedOrSane) {
    const std::string good = kGood;
    RandomStream random(StreamKey{.study = 33, .purpose = Purpose::kLinkLoss});
    for (int i = 0; i < 5000; ++i) {
        std::string text = good.substr(0, 1 + random.below(static_cast<std::uint32_t>(good.size())));
        if (i % 2 == 0) text = good;
        for (int change = 0; change < 3; ++change)
            text[random.below(static_cast<std::uint32_t>(text.size()))] =
                "{}[]\",:0e9-.xA\\\xff"[random.below(16)];
        const HaplyReading reading = read_haply_state(text, "A1");
        EXPECT_EQ(reading.state.has_value(), reading.trouble.empty()) << text;
        for (const std::string& id : haply_device_ids(text)) EXPECT_EQ(id.find('"'), std::string::npos);
        if (!reading.state) continue;
        for (const double component_m : reading.state->position_m)
            EXPECT_LT(std::fabs(component_m), DeviceMailbox::kReach_m) << text;
    }
}

TEST(HaplyMessage, AnIdentifierCannotBreakOutOfACommand) {
    EXPECT_THAT(haply_device_ids(kGood), ElementsAre("A1"));
    EXPECT_TRUE(haply_device_ids(R"({"inverse3":[{"device_id":"A\"1"},{"device_id":""}]})").empty());
    EXPECT_EQ(haply_command("A1", HaplyForceKey::kVector, {1, -2, 0}),
              R"({"inverse3":[{"device_id":"A1","commands":{"set_cursor_force":{"vector":)"
              R"({"x":1.0000,"y":-2.0000,"z":0.0000}}}}]})");
}

TEST(HaplyHandle, IsReadAndPushedAndEndsWithoutForce) {
    MockHaply service({"z=0.14"});
    LiveHandle handle(open(at_port(service)));
    EXPECT_EQ(handle->name(), "Haply Inverse3 049D");
    handle.begin();
    EXPECT_TRUE(handle.push(
        2, [&] { return service.log().find("values 049D 0.00 0.00 2.00") != std::string::npos; }));
    EXPECT_NEAR(handle.sample.position_hand_m, 0.01, 1e-6);
    EXPECT_TRUE(handle.push(50, [&] { return service.log().find(" 3.00\n") != std::string::npos; }));
    handle.reset();
    EXPECT_TRUE(service.ends_with("values 049D 0.00 0.00 0.00\nclosed\n")) << service.log();
}

TEST(HaplyHandle, TheUserCalibratesItFirst) {
    MockHaply service({"calibrated=0"});
    LiveHandle handle(open(at_port(service)));
    EXPECT_TRUE(handle.push(0, [&] { return handle->awaits().find("not calibrated") != std::string::npos; }));
    service.make("calibrated");
    EXPECT_TRUE(handle.push(0, [&] { return handle->awaits().empty(); }));
}

TEST(HaplyHandle, ASlowServiceGivesPositionsButHardlyAForce) {
    MockHaply service({"fault=slow"});
    service.make("fault");
    LiveHandle handle(open(at_port(service)));
    handle.begin();
    int withheld = 0;
    EXPECT_TRUE(handle.push(2, [&] { return (withheld += handle.sample.force_hand_N == 0 ? 1 : 0) > 20; }));
    nlohmann::ordered_json report;
    handle->describe(report);
    EXPECT_GT(report["handle"]["reads_without_force"], 10);
    EXPECT_EQ(report["handle"]["device"], "Haply Inverse3 049D");
}

TEST(HaplyHandle, AnAnswerThatNeverComesCostsTheForceForAWhile) {
    MockHaply service({"fault=drop"});
    LiveHandle handle(open(at_port(service)));
    handle.begin();
    const auto pushed_after = [&](const char* words) {
        const std::string log = service.log();
        const std::size_t from = log.find(words);
        return from != std::string::npos && log.find(" 2.00\n", from) != std::string::npos;
    };
    EXPECT_TRUE(handle.push(2, [&] { return pushed_after("values"); }));
    service.make("fault");
    EXPECT_TRUE(handle.push(2, [&] { return pushed_after("dropped"); })) << service.log();
    EXPECT_TRUE(handle->fault().empty());
}

TEST(HaplyHandle, OfManyMessagesTheNewestIsTaken) {
    MockHaply service({"fault=late"});
    LiveHandle handle(open(at_port(service)));
    service.make("fault");
    handle.begin();
    int samples = 0, old = 0;
    EXPECT_TRUE(handle.push(0, [&] {
        old += std::fabs(handle.sample.position_hand_m) > 0.001 ? 1 : 0;
        return ++samples > 100;
    }));
    EXPECT_EQ(old, 0);
}

struct HaplyFault {
    const char* word;
    const char* says;
};
std::ostream& operator<<(std::ostream& out, const HaplyFault& fault) { return out << fault.word; }
class HaplyFaults : public testing::TestWithParam<HaplyFault> {};

TEST_P(HaplyFaults, TakesTheForceAwayAndSaysWhy) {
    MockHaply service({std::string("fault=") + GetParam().word});
    LiveHandle handle(open(at_port(service)));
    handle.begin();
    EXPECT_TRUE(handle.push(2, [&] { return service.log().find(" 2.00\n") != std::string::npos; }));
    service.make("fault");
    EXPECT_TRUE(handle.ends(2));
    EXPECT_THAT(std::string(handle->fault()), HasSubstr("Haply Inverse3 049D"));
    // On a machine that stalls the handle may give up before the exchange has its reason.
    EXPECT_THAT(std::string(handle->fault()),
                testing::AnyOf(HasSubstr(GetParam().says), HasSubstr("has sent no usable position")));
    EXPECT_LT(handle->fault().size(), DeviceFault{}.text.size());
    EXPECT_EQ(handle->read(wall_now()).force_hand_N, 0);
    EXPECT_FALSE(handle->read(wall_now()).valid);
    handle.reset();
    const bool cut = std::string(GetParam().word) == "close" || std::string(GetParam().word) == "huge";
    EXPECT_TRUE(service.ends_with(cut ? "closed\n" : "0.00 0.00 0.00\nclosed\n")) << service.log();
}

INSTANTIATE_TEST_SUITE_P(Each, HaplyFaults,
                         testing::Values(HaplyFault{"silent", "does not answer"},
                                         HaplyFault{"close", "connection to the service was closed"},
                                         HaplyFault{"garbage", "not JSON"}, HaplyFault{"deep", "not JSON"},
                                         HaplyFault{"nan", "not JSON"},
                                         HaplyFault{"far", "no cursor_position"},
                                         HaplyFault{"other", "no longer lists the device"},
                                         HaplyFault{"huge", "connection to the service was closed"}),
                         [](const auto& fault) { return std::string(fault.param.word); });

TEST(HaplyHandle, SaysWhichDeviceItCannotHave) {
    HaplySettings nobody;
    nobody.port = 1;
    EXPECT_THAT(why_not(nobody),
                HasSubstr("no Haply Inverse Service at ws://localhost:1: Connection refused"));
    EXPECT_THAT(why_not(nobody), HasSubstr("systemctl start haply-inverse-service"));
    for (const char* words : {"speaks=http", "speaks=nothing"}) {  // the second is not waited for long
        const MockHaply alien({words});
        EXPECT_THAT(why_not(at_port(alien)), HasSubstr("no Haply Inverse Service at")) << words;
    }
    const MockHaply empty({"devices="});
    EXPECT_THAT(why_not(at_port(empty)), HasSubstr("lists no Inverse3: plug it in"));
    const MockHaply two({"devices=A1,B2"});
    HaplySettings settings = at_port(two);
    EXPECT_THAT(why_not(settings), HasSubstr("lists A1, B2: name one in [handle.haply] device_id"));
    settings.device_id = "C3";
    EXPECT_THAT(why_not(settings), HasSubstr("no Inverse3 'C3'; the service lists A1, B2"));
    settings.device_id = "B2";
    EXPECT_EQ(open(settings)->name(), "Haply Inverse3 B2");
}

}  // namespace
}  // namespace thimble
