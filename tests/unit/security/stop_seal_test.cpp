#include "common/security/stop_seal.hpp"

#include <gtest/gtest.h>

#include "common/codec.hpp"
#include "common/stop_bus.hpp"
#include "common/stop_inquiry.hpp"
#include "tests/unit/security/security_rig.hpp"

namespace thimble {
namespace {

constexpr std::uint16_t kStopPort = 27028;

// Two programs on a stop bus, under one lab key.
struct StopRig {
    TestPipe pipe;
    StopSeal here{pipe.a, test_lab_key(), kStopPort, StopEnd::kSpeaks};
    StopSeal there{pipe.b, test_lab_key(), kStopPort, StopEnd::kListens};
    Encoder encoder;

    Datagram order(StopKind kind) {
        Header header;
        header.sender = Role::kExperimenter;
        const Bytes bytes = encoder.encode(header, StopOrder(5, kind, EndReason::kEmergencyStop, "smoke"));
        return {bytes.begin(), bytes.end()};
    }
    bool arrives(StopKind kind) {
        const Datagram sent = order(kind);
        here.send(sent);
        const Bytes got = there.receive();
        return std::equal(got.begin(), got.end(), sent.begin(), sent.end());
    }
};

TEST(StopSeal, CarriesStopsAndReleases) {
    StopRig rig;
    EXPECT_TRUE(rig.arrives(StopKind::kStop));
    EXPECT_TRUE(rig.arrives(StopKind::kRelease));
    EXPECT_EQ(rig.there.counters().opened, 2U);
}

TEST(StopSeal, EveryFlippedBitIsRefused) {
    StopRig rig;
    ASSERT_TRUE(rig.arrives(StopKind::kRelease));
    const Datagram good = rig.pipe.a.said.back();
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
        Datagram bad = good;
        bad[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
        rig.pipe.b.deliver(bad);
        EXPECT_TRUE(rig.there.receive().empty()) << bit;
    }
    for (std::size_t size = 0; size < good.size(); ++size) {
        rig.pipe.b.deliver(Datagram(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)));
        EXPECT_TRUE(rig.there.receive().empty()) << size;
    }
    EXPECT_EQ(rig.there.counters().opened, 1U);
}

TEST(StopSeal, AnotherLabsStopAndAnotherRigsOrPortsOrderAreNone) {
    StopRig rig;
    StopSeal other_rig(rig.pipe.a,
                       std::make_shared<const LabKey>(key_of_rig(*test_lab_key(), "name B 27000")), kStopPort,
                       StopEnd::kSpeaks);
    StopSeal stranger(rig.pipe.a, test_lab_key(8), kStopPort, StopEnd::kSpeaks);
    StopSeal beside(rig.pipe.a, test_lab_key(), kStopPort + 33, StopEnd::kSpeaks);
    for (StopSeal* other : {&stranger, &beside, &other_rig}) {
        other->send(rig.order(StopKind::kRelease));
        EXPECT_TRUE(rig.there.receive().empty());
    }
    rig.pipe.b.deliver(rig.order(StopKind::kStop));  // in the clear
    EXPECT_TRUE(rig.there.receive().empty());
    EXPECT_EQ(rig.there.counters().forged, 3U);
    EXPECT_EQ(rig.there.counters().unsealed, 1U);
}

// A program on a stop bus under a lab key, and the end at which others reach it.
struct SealedProgram {
    explicit SealedProgram(std::uint64_t instance, std::uint16_t port = kStopPort)
        : inlet(wire.b, test_lab_key(), port, StopEnd::kListens),
          outlet(wire.a, test_lab_key(), port, StopEnd::kSpeaks),
          line(Role::kMaster, instance) {
        line.connect(inlet, {&nobody, &nobody, &nobody, &nobody, &nobody, &nobody});
    }
    void say(StopKind kind, std::uint64_t id, const char* words) {
        Encoder encoder;
        outlet.send(encoder.encode(Header{3, {}, 1, 0, Role::kExperimenter},
                                   StopOrder(id, kind, EndReason::kEmergencyStop, words)));
    }
    void tick(int ms) { line.tick(SessionTime{std::chrono::milliseconds{ms}}); }
    // An inquiry that has just begun, over 0.7 s from `ms`.
    std::size_t release_from(int ms) {
        StopRelease release(77, {&outlet, &nobody, &nobody, &nobody, &nobody, &nobody});
        for (int i = 0; i < StopRelease::kRounds; ++i) {
            release.round(SessionTime{std::chrono::milliseconds{ms + 50 * i}});
            tick(ms + 50 * i + 1);
        }
        return release.stops().size();
    }
    // All that was ever said to it, once more.
    void hear_again(const std::vector<Datagram>& said, int ms) {
        for (const Datagram& datagram : said) {
            wire.b.deliver(datagram);
            tick(ms);
        }
    }
    TestPipe wire;
    TestWire nobody;
    StopSeal inlet, outlet;
    StopBus line;
};

std::vector<Datagram> recorded_stop_and_release(SealedProgram& program) {
    program.say(StopKind::kStop, 5, "smoke");
    program.tick(1);
    EXPECT_TRUE(program.line.stopped());
    EXPECT_EQ(program.release_from(100), 1U) << "once it has been held for 200 ms";
    EXPECT_FALSE(program.line.stopped());
    return program.wire.a.said;
}

TEST(StopSeal, ARecordedReleaseLetsGoOfNothing) {
    SealedProgram program(1);
    const std::vector<Datagram> said = recorded_stop_and_release(program);
    ASSERT_GT(said.size(), 10U);
    // The next stop of the same program, another rig under the same key and with the same ports, and a program that was started
    // anew: each holds, whatever is played and in whichever order.
    SealedProgram other_rig(2), started_anew(1);
    for (SealedProgram* held : {&program, &other_rig, &started_anew}) {
        held->line.stop(SessionTime{std::chrono::seconds{2}}, EndReason::kEmergencyStop, "still smoke");
        held->hear_again(said, 2300);
        held->hear_again({said.rbegin(), said.rend()}, 2600);
        EXPECT_TRUE(held->line.stopped());
        EXPECT_EQ(held->line.words(), "still smoke");
        held->release_from(3000);
        EXPECT_FALSE(held->line.stopped());
    }
}

// A table full of recorded stops has room for a real one, and none of their releases ends it.
TEST(StopSeal, RecordedStopsDoNotCrowdOutAnother) {
    std::vector<Datagram> stops, releases;
    SealedProgram recorder(1);
    for (std::uint64_t id = 1; id <= 20; ++id) {
        for (const StopKind kind : {StopKind::kStop, StopKind::kRelease}) {
            recorder.say(kind, id, "old");
            (kind == StopKind::kStop ? stops : releases).push_back(recorder.wire.a.said.back());
        }
    }
    SealedProgram program(2);
    program.hear_again(stops, 1);
    program.say(StopKind::kStop, 99, "real");
    program.tick(2);
    program.hear_again(stops, 3);
    program.hear_again(releases, 300);
    EXPECT_TRUE(program.line.stopped());
    program.release_from(1000);
    EXPECT_FALSE(program.line.stopped());
}

// A program that holds "first", which is released at 1 s while "second" is pressed, in rounds that take `round`.
struct ReleasedWhilePressed : SealedProgram {
    explicit ReleasedWhilePressed(std::chrono::milliseconds round) : SealedProgram(1), round_(round) {
        line.stop(SessionTime{}, EndReason::kEmergencyStop, "first");
    }
    // `meanwhile`: what is done to the program's wire after each round.
    template <class Meanwhile>
    void run(Meanwhile&& meanwhile) {
        for (int i = 0; i < StopRelease::kRounds; ++i) {
            const SessionTime now{std::chrono::milliseconds{1000} + i * round_};
            release.round(now);
            if (i == 0) say(StopKind::kStop, 6, "second");
            meanwhile();
            line.tick(now + round_ / 2);
        }
    }
    StopRelease release{77, {&outlet, &nobody, &nobody, &nobody, &nobody, &nobody}};

  private:
    std::chrono::milliseconds round_;
};

TEST(StopSeal, AStopThatIsPressedDuringTheReleaseHolds) {
    for (const int round_ms : {50, 150, 400}) {  // the later, on a machine that is busy
        ReleasedWhilePressed program(std::chrono::milliseconds{round_ms});
        program.run([] {});
        EXPECT_TRUE(program.line.stopped()) << round_ms;
        EXPECT_EQ(program.line.words(), "second") << round_ms;
        EXPECT_EQ(program.release.stops().size(), 1U) << round_ms;
    }
}

// By a program that ends with it, and may not be there for a question.
TEST(StopSeal, AStopFromOutsideIsAnsweredAtOnceAndOneOfAProgramIsNot) {
    for (const Role sender : {Role::kExperimenter, Role::kVisual}) {
        SealedProgram program(1);
        OutboundFlow flow(sender, 3, {&program.outlet});
        StopInquiry inquiry(flow,
                            {&program.outlet, &program.nobody, &program.nobody, &program.nobody,
                             &program.nobody, &program.nobody},
                            6);
        flow.send(SessionTime{}, 0, StopOrder(6, StopKind::kStop, EndReason::kEmergencyStop, "smoke"));
        program.tick(1);
        inquiry.hear(SessionTime{});
        EXPECT_EQ(inquiry.held().size(), sender == Role::kExperimenter ? 1U : 0U);
    }
}

// Overheard questions and stops are replayed, to the program and to the releasing program.
TEST(StopSeal, WhatIsOverheardNamesNoStopThatIsPressedDuringTheRelease) {
    ReleasedWhilePressed program(std::chrono::milliseconds{100});
    program.run([&] {
        const std::vector<Datagram> said = program.wire.a.said;
        for (const Datagram& datagram : said) {
            program.wire.a.deliver(datagram);
            program.wire.b.deliver(datagram);
        }
    });
    EXPECT_TRUE(program.line.stopped());
    EXPECT_EQ(program.line.words(), "second");
}

}  // namespace
}  // namespace thimble
