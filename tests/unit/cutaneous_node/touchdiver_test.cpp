// WEART's middleware as text, and as the node's actuator: when it presses, when it lets go, and what it says of a middleware that is
// slow, wrong or gone.
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cutaneous_node/touchdiver/touchdiver_actuator.hpp"
#include "tests/allocation_count.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

constexpr const char* kRunning =
    R"({"type": "MW_STATUS", "ts": 12, "data": {"status": "RUNNING", "version": "1.2.3", "statusCode": 0, )"
    R"("errorDesc": "", "actuationsEnabled": true, "connectedDevices": [{"macAddress": "00:1A", "handSide": )"
    R"("RIGHT"}, {"macAddress": "00:1B", "handSide": "LEFT"}]}})";

std::string with(std::string text, const std::string& old, const std::string& now) {
    return text.replace(text.find(old), old.size(), now);
}

TEST(MiddlewareText, CommandsAreThoseOfTheSdk) {
    std::string words;
    add_force(words, GloveSide::kRight, Thimble::kIndex, 0.3);
    EXPECT_EQ(words, "force:0.300000:0.000000:0.000000:RIGHT:INDEX~");
    words.clear();
    add_stop_force(words, GloveSide::kLeft, Thimble::kMiddle);
    EXPECT_EQ(words, "stopForce:LEFT:MIDDLE~");
    words.clear();
    add_question(words, MiddlewareKind::kMiddleware, 7);
    EXPECT_EQ(words, R"({"type":"MW_GET_STATUS","ts":7}~)");
    add_question(words, MiddlewareKind::kApp, 8);
    EXPECT_THAT(words, testing::EndsWith(R"({"type":"WA_GET_STATUS","ts":8}~)"));
}

TEST(MiddlewareText, AStateIsReadInAnyOrderAndWithMembersThatAreNew) {
    const auto status = read_middleware_status(kRunning);
    ASSERT_TRUE(status);
    EXPECT_EQ(status->phase, "RUNNING");
    EXPECT_TRUE(status->left && status->right && status->actuations);
    const auto other = read_middleware_status(
        R"({"data":{"connectedDevices":[{"handSide":"LEFT","more":[1,"}",{}]}],"errorDesc":"say \"~no\"",)"
        R"("statusCode":202,"status":"IDLE","actuationsEnabled":false,"new":null},"type":"WA_STATUS"})");
    ASSERT_TRUE(other);
    EXPECT_EQ(other->kind, MiddlewareKind::kApp);
    EXPECT_EQ(other->code, 202);
    EXPECT_EQ(other->problem, R"(say \"~no\")");
    EXPECT_TRUE(other->left && !other->right && !other->actuations);
    // An older one that lists no devices is believed.
    EXPECT_TRUE(read_middleware_status(R"({"type":"MW_STATUS","data":{"status":"IDLE"}})")->right);
}

TEST(MiddlewareText, AnyStateCutShortIsNone) {
    const std::string whole = kRunning;
    for (std::size_t size = 0; size < whole.size(); ++size)
        EXPECT_FALSE(read_middleware_status(whole.substr(0, size))) << size;
    for (std::size_t i = 0; i < whole.size(); ++i) {  // whatever it makes of them, it ends
        std::string wrong = whole;
        for (const char c : {'"', '\\', '{', ']', ':', '\0'}) {
            wrong[i] = c;
            read_middleware_status(wrong);
        }
    }
    EXPECT_FALSE(read_middleware_status(whole + "}"));
    EXPECT_FALSE(read_middleware_status(R"({"type":"DEVICES_STATUS","data":{"devices":[]}})"));
    EXPECT_TRUE(is_middleware_message("Tracking:TrackType1:0:0:0:0:0:0:0:0"));
    EXPECT_FALSE(is_middleware_message("HTTP/1.1 400 Bad Request"));
}

// The far end, by hand.
class FakeStream final : public ByteStream {
  public:
    void connect() override {
        ++connects;
        if (listening) now_ = State::kOpen;
    }
    State state() override { return now_; }
    std::size_t send(std::string_view bytes) override {
        const std::size_t taken = std::min(room, bytes.size());
        told += bytes.substr(0, taken);
        room -= taken;
        return taken;
    }
    std::size_t receive(std::span<char> space) override {
        const std::size_t size = std::min(space.size(), said.size());
        said.copy(space.data(), size);
        said.erase(0, size);
        return size;
    }
    void close() override { now_ = State::kClosed; }
    std::string_view why() const override { return "Connection refused"; }

    bool listening = true;
    int connects = 0;
    std::size_t room = std::numeric_limits<std::size_t>::max();
    std::string told, said;

  private:
    State now_ = State::kClosed;
};

class TouchDiver : public testing::Test {
  protected:
    // Ticks of a millisecond; the middleware answers each question, unless it is mute.
    void turn(Duration time = milliseconds{1}) {
        for (const SessionTime end = now + time; now < end; now += milliseconds{1}) {
            actuator.tick(now);
            if (!answer.empty() && stream.told.find("GET_STATUS", asked) != std::string::npos) {
                asked = stream.told.size();
                stream.said += answer + "~";
            }
        }
    }
    void start() {
        turn(milliseconds{5});
        ASSERT_THAT(actuator.fault(), IsEmpty());
        forget();
    }
    void forget() {
        stream.told.clear();
        asked = 0;
    }

    FakeStream stream;
    std::string answer = kRunning;
    std::size_t asked = 0;
    SessionTime now = at(seconds{3});
    TouchDiverActuator actuator{TouchDiverSettings{}, 1.5, stream};
};

TEST_F(TouchDiver, StartsTheMiddlewareAndPressesNobodyAtFirst) {
    EXPECT_THAT(actuator.fault(), HasSubstr("no connection"));
    turn(milliseconds{5});
    EXPECT_THAT(stream.told, StartsWith("StartFromClient~"));
    EXPECT_THAT(stream.told, HasSubstr("force:0.000000:0.000000:0.000000:LEFT:THUMB~"));
    EXPECT_THAT(stream.told, HasSubstr("force:0.000000:0.000000:0.000000:RIGHT:INDEX~"));
    EXPECT_THAT(stream.told, Not(HasSubstr("MIDDLE")));
    EXPECT_THAT(actuator.fault(), IsEmpty());
}

TEST_F(TouchDiver, PressesTheFingerOfTheHandWithinItsLimit) {
    start();
    actuator.command(now, Finger::kIndex, 1.0);
    turn();
    EXPECT_EQ(stream.told, "force:0.200000:0.000000:0.000000:RIGHT:INDEX~");
    EXPECT_EQ(actuator.output(now).finger, Finger::kIndex);
    EXPECT_DOUBLE_EQ(actuator.output(now).force_N, 1.0);
    forget();
    turn(milliseconds{10});
    actuator.command(now, Finger::kThumb, 99);
    turn();
    EXPECT_THAT(stream.told, HasSubstr("force:0.300000:0.000000:0.000000:RIGHT:THUMB~"));
    EXPECT_THAT(stream.told, HasSubstr("force:0.000000:0.000000:0.000000:RIGHT:INDEX~"));
    forget();
    actuator.use_hand(now, Hand::kOther);
    EXPECT_EQ(stream.told, "force:0.000000:0.000000:0.000000:RIGHT:THUMB~") << "at once";
    turn(milliseconds{10});
    actuator.command(now, Finger::kIndex, 0.5);
    turn();
    EXPECT_THAT(stream.told, HasSubstr("force:0.100000:0.000000:0.000000:LEFT:INDEX~"));
    actuator.command(now, Finger::kIndex, std::numeric_limits<double>::quiet_NaN());
    turn();
    EXPECT_EQ(actuator.output(now).force_N, 0);
}

TEST_F(TouchDiver, ForcesKeepTheirDistanceAndNoForceDoesNot) {
    start();
    for (int i = 0; i < 100; ++i) {
        actuator.command(now, Finger::kIndex, 0.5 + 0.01 * i);
        turn();
    }
    EXPECT_LE(actuator.forces(), 4U + 10U);
    EXPECT_GE(actuator.forces(), 4U + 9U);
    turn(milliseconds{10});
    EXPECT_NEAR(actuator.output(now).force_N, 1.49, 0.01) << "the newest one arrives";
    forget();
    actuator.release(now);
    EXPECT_EQ(stream.told, "force:0.000000:0.000000:0.000000:RIGHT:INDEX~");
}

TEST_F(TouchDiver, OneThatIsSilentOrSaysGarbageIsTroubleAndGetsNoForce) {
    start();
    for (const std::string& words : {std::string(), std::string("HTTP/1.1 400 Bad Request~")}) {
        answer = words;
        actuator.command(now, Finger::kIndex, 1.0);
        turn(milliseconds{650});
        EXPECT_THAT(actuator.fault(), HasSubstr("no report of its state for 500 ms"));
        EXPECT_THAT(stream.told, testing::ContainsRegex("force:0.000000:0.000000:0.000000:RIGHT:INDEX~"));
        EXPECT_EQ(actuator.output(now).force_N, 0);
        answer = kRunning;
        turn(milliseconds{200});
        EXPECT_THAT(actuator.fault(), IsEmpty()) << "it speaks again";
    }
    const auto before = actuator.bad_messages();
    EXPECT_GT(before, 3U);
    stream.said = std::string(20000, 'x');  // never ends
    turn(milliseconds{5});
    EXPECT_GT(actuator.bad_messages(), before);
}

TEST_F(TouchDiver, AStallOfThisComputerIsNoSilenceOfTheMiddleware) {
    start();
    now += seconds{2};
    turn();
    EXPECT_THAT(actuator.fault(), IsEmpty());
}

// The rest of the old force does not come after the silence.
TEST_F(TouchDiver, OneThatDoesNotReadIsTroubleAndLosesItsConnection) {
    start();
    stream.room = 10;
    actuator.command(now, Finger::kIndex, 1.0);
    turn(milliseconds{450});
    EXPECT_EQ(stream.told, "force:0.20") << "a slow one keeps its connection";
    EXPECT_EQ(stream.connects, 1);
    forget();
    stream.listening = false;
    turn(milliseconds{100});
    EXPECT_EQ(stream.state(), ByteStream::State::kClosed);
    EXPECT_THAT(actuator.fault(), HasSubstr("no connection"));
    EXPECT_EQ(actuator.output(now).force_N, 0);
    stream.room = 100000;
    stream.listening = true;
    actuator.release(now);
    turn(milliseconds{1100});
    EXPECT_THAT(stream.told, StartsWith("StartFromClient~force:0.000000:0.000000:0.000000:LEFT:THUMB~"));
    EXPECT_THAT(stream.told, HasSubstr("force:0.000000:0.000000:0.000000:RIGHT:INDEX~"));
    EXPECT_THAT(stream.told, Not(HasSubstr("force:0.2")));
}

TEST_F(TouchDiver, AConnectionThatEndsIsTroubleAtOnceAndIsTriedEachSecond) {
    start();
    actuator.command(now, Finger::kIndex, 1.0);
    turn();
    stream.listening = false;
    stream.close();
    turn();
    EXPECT_THAT(actuator.fault(), HasSubstr("no connection (Connection refused); start WEART's middleware"));
    EXPECT_EQ(actuator.output(now).force_N, 0);
    const int before = stream.connects;
    turn(seconds{3});
    EXPECT_GE(stream.connects, before + 2);
    EXPECT_LE(stream.connects, before + 4);
    stream.listening = true;
    forget();
    turn(milliseconds{1100});
    EXPECT_THAT(stream.told, StartsWith("StartFromClient~"));
    EXPECT_THAT(actuator.fault(), IsEmpty());
}

TEST_F(TouchDiver, EachStateThatDoesNotPressIsNamedWithItsRemedy) {
    start();
    const auto says = [&](const std::string& old, const std::string& words) {
        answer = with(kRunning, old, words);
        turn(milliseconds{110});
        return std::string(actuator.fault());
    };
    EXPECT_THAT(says("RUNNING", "DISCONNECTED"), HasSubstr("it is DISCONNECTED, not RUNNING; connect"));
    EXPECT_THAT(says(R"("RUNNING", "version": "1.2.3", "statusCode": 0, "errorDesc": "")",
                     R"("IDLE", "statusCode": 202, "errorDesc": "TouchDIVER disconnected)"
                     "\n"
                     R"(while")"),
                HasSubstr("it is IDLE, not RUNNING (code 202: TouchDIVER disconnected?while)"));
    EXPECT_THAT(says("true", "false"), HasSubstr("actuations are switched off"));
    EXPECT_THAT(says("RIGHT", "LEFT"), HasSubstr("no device for the right hand"));
    actuator.use_hand(now, Hand::kOther);
    turn();
    EXPECT_THAT(actuator.fault(), IsEmpty());
}

TEST_F(TouchDiver, ADeviceThatComesLateIsStartedAndOneThatWasStoppedIsNot) {
    answer = with(kRunning, "RUNNING", "IDLE");
    turn(milliseconds{1200});
    EXPECT_NE(stream.told.find("StartFromClient", 5), std::string::npos);
    answer = kRunning;
    turn(milliseconds{200});
    answer = with(kRunning, "RUNNING", "IDLE");
    forget();
    turn(seconds{3});
    EXPECT_THAT(stream.told, Not(HasSubstr("StartFromClient")));
}

TEST_F(TouchDiver, TheEndIsNoForceAndAStop) {
    start();
    actuator.command(now, Finger::kIndex, 1.0);
    turn();
    forget();
    actuator.stop();
    answer = with(kRunning, "RUNNING", "IDLE");
    turn(seconds{2});
    EXPECT_THAT(stream.told,
                HasSubstr("force:0.000000:0.000000:0.000000:RIGHT:INDEX~stopForce:RIGHT:INDEX~"));
    EXPECT_THAT(stream.told, testing::EndsWith("StopFromClient~"));
}

TEST_F(TouchDiver, ATickAllocatesNothing) {
    start();
    stream.told.reserve(100000);
    stream.said.reserve(100000);
    turn(milliseconds{300});
    const auto before = test::allocation_count();
    for (int i = 0; i < 300; ++i) {
        actuator.command(now, Finger::kThumb, 0.01 * (i % 100));
        actuator.tick(now);
        actuator.output(now);
        if (i % 50 == 0) stream.said = kRunning;
        if (i % 50 == 1) stream.said = "~";
        now += milliseconds{1};
    }
    actuator.release(now);
    EXPECT_EQ(test::allocation_count(), before);
    EXPECT_THAT(actuator.fault(), IsEmpty());
}

}  // namespace
}  // namespace thimble
