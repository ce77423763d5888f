// A program's log: what passes a tapped channel, what becomes of it, and the queue between a loop and the thread that writes.
#include "common/runtime/log/message_log.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <numeric>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/flow.hpp"
#include "common/log/byte_queue.hpp"
#include "common/queue_channel.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/text_file.hpp"
#include "session/log/logged_file.hpp"
#include "tests/allocation_count.hpp"
#include "tests/full_disk.hpp"
#include "tests/read_text.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// A control channel of the master's, its log, and the session at the other end.
struct TappedMaster {
    TemporaryDirectory folder;
    QueuePipe pipe;
    MessageLog log;
    Channel* master = log.tap(pipe.a, Port::kSessionMaster, Port::kMasterControl);
    OutboundFlow heartbeats{Role::kMaster, 7, {master}};
    OutboundFlow orders{Role::kSession, 8, {&pipe.b}};
    InboundFlow heard{Role::kSession};

    std::filesystem::path file() const { return folder.path() / "master.mcap"; }
    void start(const LogSettings& settings = {}) { log.start(file(), {"thimble-master", {}, {}}, settings); }
    void pass(int exchanges) {
        for (int i = 1; i <= exchanges; ++i) {
            heartbeats.send(from_nanoseconds(i), 1, Heartbeat{});
            orders.send(from_nanoseconds(10 * i), 1, SessionControl{});
            while (heard.receive(from_nanoseconds(i), *master) != nullptr) {
            }
            while (!pipe.b.receive().empty()) {
            }
        }
    }
};

TEST(MessageLog, KeepsWhatWasSentAndWhatWasReceived) {
    TappedMaster master;
    master.start();
    master.pass(3);
    const auto before_ns = to_nanoseconds(wall_now());
    const LogCounters counters = master.log.close();
    EXPECT_EQ(counters.messages, 6U);
    EXPECT_EQ(counters.lost, 0U);
    const LoggedFile file(master.file());
    EXPECT_TRUE(file.scan().finished);
    EXPECT_EQ(file.value("thimble", "program"), "thimble-master");
    EXPECT_EQ(file.value("end", "messages_lost"), "0");
    int sent = 0, received = 0;
    file.for_each([&](const LoggedTopic& topic, const McapMessage& m) {
        const int number = topic.sent ? ++sent : ++received;
        EXPECT_EQ(topic.topic, topic.sent ? "/master/heartbeats" : "/session/orders/master");
        EXPECT_EQ(m.sequence, static_cast<std::uint32_t>(number));
        EXPECT_EQ(m.publish_time_ns, static_cast<std::uint64_t>(topic.sent ? number : 10 * number));
        EXPECT_LE(m.log_time_ns, static_cast<std::uint64_t>(before_ns));
    });
    EXPECT_EQ(sent, 3);
    EXPECT_EQ(received, 3);
}

TEST(MessageLog, InLockStepMessagesHaveTheGrantedTimeAndNoThreadWritesThem) {
    TappedMaster master;
    master.log.take_time({});
    master.start();
    EXPECT_FALSE(master.log.running());
    for (const int now_ns : {5000, 7000}) {
        master.log.take_time(from_nanoseconds(now_ns));
        master.pass(1);
    }
    EXPECT_EQ(master.log.close().messages, 4U);
    EXPECT_EQ(master.log.close().messages, 4U) << "once is enough";
    const LoggedFile file(master.file());
    EXPECT_TRUE(file.scan().finished);
    std::vector<std::uint64_t> times_ns;
    file.for_each([&](const LoggedTopic&, const McapMessage& m) { times_ns.push_back(m.log_time_ns); });
    EXPECT_THAT(times_ns, testing::ElementsAre(5000, 5000, 7000, 7000));
    EXPECT_EQ(file.value("thimble", "monotonic_ns"), "0") << "the clock of its messages";
    EXPECT_EQ(log_path_of_trial("nodes/session_50ms.mcap", 2), "nodes/session_50ms_trial02.mcap");
}

TEST(MessageLog, WhatIsNoMessageHasATopicOfItsOwn) {
    TappedMaster master;
    master.start();
    const std::array<std::uint8_t, 5> noise{1, 2, 3, 4, 5};
    master.pipe.b.send(noise);
    master.pass(1);
    master.log.close();
    const LoggedFile file(master.file());
    std::vector<std::string> unreadable;
    file.for_each([&](const LoggedTopic& topic, const McapMessage& m) {
        if (!topic.readable) unreadable.push_back(topic.topic + std::to_string(m.data.size()));
    });
    EXPECT_THAT(unreadable, testing::ElementsAre("/session/orders/master/unreadable5"));
}

TEST(MessageLog, TheSessionFileAndNotesGoAlong) {
    TappedMaster master;
    const auto session = master.folder.path() / "session.toml";
    write_text_file(session, "# a session\n");
    master.log.start(master.file(), {"thimble-master", session, {}}, {});
    master.log.note("clock_offset", {{"node", "master"}});
    master.log.close();
    const LoggedFile file(master.file());
    ASSERT_THAT(file.attachments(), SizeIs(1));
    EXPECT_EQ(file.attachments()[0].name, "session.toml");
    EXPECT_EQ(file.attachments()[0].bytes, 12U);
    EXPECT_EQ(file.value("clock_offset", "node"), "master");
}

TEST(MessageLog, ItsLoopAllocatesNothing) {
    TappedMaster master;
    master.pass(2);
    const auto before = test::allocation_count();
    master.pass(100);
    EXPECT_EQ(test::allocation_count(), before);
}

// Before start() the queue is not drained, as with a disk that hangs.
TEST(MessageLog, OverflowIsCountedAndRecorded) {
    TappedMaster master;
    master.pass(20000);  // 8 MB into 4
    master.start();
    const LogCounters counters = master.log.close();
    EXPECT_GT(counters.lost, 0U);
    EXPECT_EQ(counters.messages + counters.lost, 40000U);
    const LoggedFile file(master.file());
    EXPECT_EQ(file.lost(), counters.lost);
    EXPECT_EQ(file.value("overflow", "messages_lost"), std::to_string(counters.lost));
}

// Written within the period, and readable without the end.
TEST(MessageLog, IsThereBeforeItIsClosed) {
    TappedMaster master;
    master.start();
    master.pass(3);
    const SessionTime patience = wall_now() + std::chrono::seconds{10};
    while (LoggedFile(master.file()).scan().messages < 6 && wall_now() < patience) wall_sleep(kLogPeriod / 4);
    const LoggedFile file(master.file());
    EXPECT_EQ(file.scan().messages, 6U);
    EXPECT_FALSE(file.scan().finished);
}

TEST(MessageLog, NeverOverwrites) {
    TappedMaster master;
    write_text_file(master.file(), "precious");
    EXPECT_THAT(refusal([&] { master.start(); }, ExitCode::kUsage), HasSubstr("never overwritten"));
}

// @mcap/core is not Thimble's, and finds the same in a file as Thimble does.
TEST(IndependentReader, OpensOurLogs) {
    const std::filesystem::path modules = THIMBLE_SOURCE_DIR "/build/log_reader/node_modules";
    if (!std::filesystem::exists(modules / "@mcap/core"))
        GTEST_SKIP() << "@mcap/core is not installed: deploy/install-log-reader does that where there is npm "
                        "(package npm)";
    TappedMaster master;
    const auto session = master.folder.path() / "session.toml";
    write_text_file(session, "# a session\n");
    master.log.start(master.file(), {"thimble-master", session, {}}, {});
    master.pass(100);
    wall_sleep(2 * kLogPeriod);
    master.pass(10);
    master.log.close();
    // Modules are sought beside the script.
    std::filesystem::copy_file(THIMBLE_SOURCE_DIR "/tests/log_reader/read_log.mjs",
                               master.folder.path() / "read_log.mjs");
    std::filesystem::create_directory_symlink(modules, master.folder.path() / "node_modules");
    const auto said = master.folder.path() / "said";
    const std::string command = "node '" + (master.folder.path() / "read_log.mjs").string() + "' '" +
                                master.file().string() + "' > '" + said.string() + "' 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0) << read_text(said);
    const auto found = nlohmann::json::parse(read_text(said));
    EXPECT_EQ(found["messages"],
              nlohmann::json::parse(R"({"/master/heartbeats": 110, "/session/orders/master": 110})"));
    EXPECT_EQ(found["indexed"], 220);
    EXPECT_EQ(found["statistics"], 220);
    EXPECT_EQ(found["times_go_up"], true);
    EXPECT_EQ(found["schemas"], nlohmann::json::parse(R"([["thimble.wire.Packet", "flatbuffer", "BFBS"]])"));
    EXPECT_EQ(found["attachments"], nlohmann::json::parse(R"(["session.toml"])"));
    EXPECT_EQ(found["metadata"], nlohmann::json::parse(R"(["thimble", "end"])"));
}

TEST(MessageLog, AFullDiskIsToldAndKeepsWhatWasWritten) {
    TappedMaster master;
    {
        const FullDisk disk(60000);
        master.start();
        master.pass(3);
        const SessionTime patience = wall_now() + std::chrono::seconds{10};
        while (LoggedFile(master.file()).scan().messages < 6 && wall_now() < patience)
            wall_sleep(kLogPeriod / 4);
        master.pass(500);  // 200 kB
        while (master.log.fault().empty() && wall_now() < patience) wall_sleep(kLogPeriod / 4);
        EXPECT_THAT(std::string(master.log.fault()),
                    HasSubstr("master.mcap' cannot be written: File too large; free disk space"));
        EXPECT_LT(master.log.fault().size(), sizeof(DeviceFault::text));
        EXPECT_GT(master.log.close().lost, 0U);
    }
    const LoggedFile file(master.file());
    EXPECT_GE(file.scan().messages, 6U);
    EXPECT_THAT(file.scan().flaws, IsEmpty());
}

TEST(MessageLog, ADiskThatIsFullFromTheFirstMessageOnLosesNoneUncounted) {
    TappedMaster master;
    master.log.take_time({});
    master.start();
    const FullDisk disk(std::filesystem::file_size(master.file()));
    master.pass(3);
    EXPECT_EQ(master.log.close().lost, 6U);
}

// The queue between a loop and the thread that writes.
std::vector<std::uint8_t> numbered(std::size_t size, std::uint8_t first) {
    std::vector<std::uint8_t> bytes(size);
    std::iota(bytes.begin(), bytes.end(), first);
    return bytes;
}

TEST(ByteQueue, CountsWhatDoesNotFit) {
    ByteQueue queue(1024);
    const auto bytes = numbered(240, 0);  // 256 with its head
    const auto before = test::allocation_count();
    for (int i = 0; i < 6; ++i) queue.push(0, 0, bytes);
    EXPECT_EQ(test::allocation_count(), before);
    EXPECT_EQ(queue.lost(), 2U);
    int drained = 0;
    queue.drain([&](const ByteQueue::Entry&, Bytes) { ++drained; });
    EXPECT_EQ(drained, 4);
    EXPECT_TRUE(queue.push(0, 0, bytes));
}

TEST(ByteQueue, NeverAllocatesWhenItWraps) {
    ByteQueue queue(4096);
    const auto bytes = numbered(200, 0);
    int drained = 0;
    const auto before = test::allocation_count();
    for (int i = 0; i < 100; ++i) {
        queue.push(0, 0, bytes);
        queue.drain([&](const ByteQueue::Entry&, Bytes) { ++drained; });
    }
    EXPECT_EQ(test::allocation_count(), before);
    EXPECT_EQ(drained, 100);
}

TEST(ByteQueue, TwoThreadsLoseNothingUncounted) {
    ByteQueue queue(4096);
    constexpr std::uint32_t kEntries = 50000;
    std::thread pusher([&queue] {
        const auto bytes = numbered(256 + kMaxDatagramBytes, 0);
        for (std::uint32_t i = 0; i < kEntries; ++i)
            queue.push(7, i, Bytes(bytes).subspan(i % 256, i % (kMaxDatagramBytes + 1)));
    });
    std::uint64_t drained = 0;
    std::int64_t newest = -1;
    const auto take = [&](const ByteQueue::Entry& entry, Bytes bytes) {
        EXPECT_EQ(entry.tag, 7);
        EXPECT_EQ(bytes.size(), static_cast<std::uint64_t>(entry.time_ns) % (kMaxDatagramBytes + 1));
        EXPECT_TRUE(
            std::ranges::equal(bytes, numbered(bytes.size(), static_cast<std::uint8_t>(entry.time_ns))));
        EXPECT_GT(entry.time_ns, newest);
        newest = entry.time_ns;
        ++drained;
    };
    while (drained + queue.lost() < kEntries) queue.drain(take);
    pusher.join();
    queue.drain(take);
    EXPECT_EQ(drained + queue.lost(), kEntries);
}

}  // namespace
}  // namespace thimble
