// The tools of `thimble log`: checks, merging, tables, JSON, repair.
#include "thimble/log/log_tools.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/codec.hpp"
#include "common/error.hpp"
#include "common/network_settings.hpp"
#include "common/text_file.hpp"
#include "tests/fuzz/packets.hpp"
#include "tests/read_text.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/log/small_log.hpp"
#include "tests/unit/log/written_log.hpp"
#include "thimble/log/log_export.hpp"

namespace thimble {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class LogTools : public testing::Test {
  protected:
    const LoggedFile& add(const std::string& name, const WrittenLog& log) {
        log.write(folder_ / (name + ".mcap"));
        files_.push_back(std::make_unique<LoggedFile>(folder_ / (name + ".mcap")));
        return *files_.back();
    }
    TemporaryDirectory folder_;
    std::vector<std::unique_ptr<LoggedFile>> files_;
};

TEST_F(LogTools, AGoodFileIsGood) {
    EXPECT_THAT(check_file(add("master", {.messages = {{1, 10}, {2, 20}, {3, 30}}})).problems, IsEmpty());
    EXPECT_THAT(describe_log(*files_[0]), HasSubstr("/master/needle_command"));
}

TEST_F(LogTools, WhatIsNotGoodIsNamed) {
    // Two that were sent are missing, and the clock went back.
    const FileFinding finding =
        check_file(add("master", {.messages = {{1, 10}, {2, 20}, {5, 15}}, .more = [](McapWriter& writer) {
                                      writer.add_metadata("overflow", {{"messages_lost", "1"}});
                                  }}));
    EXPECT_EQ(finding.missing_sent, 2U);
    EXPECT_EQ(finding.backward, 1U);
    EXPECT_THAT(finding.problems,
                ElementsAre(HasSubstr("go back 1 times"), HasSubstr("1 messages are missing"),
                            HasSubstr("2 messages were sent but are not in the log")));
}

TEST_F(LogTools, SentIsReceivedPlusLost) {
    add("master", {.messages = {{1, 10}, {2, 20}, {3, 30}, {4, 40}, {5, 50}}});
    add("slave", {.program = "thimble-slave-sim",
                  .direction = "received",  // 9: after the end of the sender's log
                  .messages = {{1, 11}, {3, 31}, {2, 32}, {3, 33}, {5, 51}, {9, 99}}});
    const auto flows = check_flows(files_);
    ASSERT_THAT(flows, SizeIs(1));
    EXPECT_EQ(flows[0].sent, 5U);
    EXPECT_EQ(flows[0].received, 4U);
    EXPECT_EQ(flows[0].lost, 1U);
    EXPECT_EQ(flows[0].outside, 0U);
    EXPECT_EQ(flows[0].repeated, 1U);
    EXPECT_EQ(flows[0].out_of_order, 1U);
    EXPECT_EQ(flows[0].foreign, 0U);
}

// Messages take 20 ns.
TEST_F(LogTools, WhatComesBeforeOrBehindTheReceiversLogIsNotLost) {
    add("master",
        {.messages = {{1, 10}, {2, 94}, {3, 96}, {4, 120}, {5, 150}, {6, 174}, {7, 176}, {8, 190}}});
    WrittenLog log{.program = "thimble-slave-sim", .direction = "received", .messages = {{3, 116}, {5, 170}}};
    const auto check = [&] {
        add(fmt::format("slave{}", log.messages.size()), log);
        const FlowFinding flow = check_flows(files_).at(0);
        EXPECT_EQ(flow.sent, flow.received + flow.lost + flow.outside);
        files_.pop_back();
        return std::pair(flow.lost, flow.outside);
    };
    // 4 lies between two that came; 6, 7 and 8 would have come after its last.
    EXPECT_EQ(check(), std::pair(std::uint64_t{1}, std::uint64_t{5}));
    log.messages.push_back({8, 210});
    EXPECT_EQ(check(), std::pair(std::uint64_t{3}, std::uint64_t{2}));
}

// It takes in heartbeats to the end, and of this flow nothing after the second.
TEST_F(LogTools, WhatIsLostWhileTheReceiverIsUpIsLost) {
    add("master", {.messages = {{1, 10}, {2, 20}, {3, 30}, {4, 40}, {5, 95}}});
    WrittenLog slave{.program = "thimble-slave-sim", .direction = "received", .messages = {{2, 21}}};
    slave.more = [](McapWriter& writer) {
        const auto schema = writer.add_schema(kWireSchemaName, "flatbuffer", wire_schema());
        const auto orders = writer.add_channel(schema, "/session/orders/slave_sim", "flatbuffer",
                                               {{"direction", "received"}});
        Encoder encoder;
        for (const std::uint64_t at_ns : {5U, 95U})
            writer.add_message(
                {orders, 1, at_ns, 0, encoder.encode({{9, {}, 1, 1, Role::kSession}, Heartbeat{}})});
    };
    add("slave", slave);
    const FlowFinding flow = check_flows(files_).at(0);
    EXPECT_EQ(flow.lost, 3U);     // 1, 3, 4
    EXPECT_EQ(flow.outside, 1U);  // 5 would have come at 96
}

// Their clocks were not compared. The check can judge what lies between the first and the last message that came.
TEST_F(LogTools, OfTwoMachinesWithoutASessionsLogOnlyTheMiddleIsJudged) {
    add("master", {.messages = {{1, 10}, {2, 20}, {3, 30}, {4, 40}, {5, 50}}});
    add("slave", {.boot = "b", .direction = "received", .messages = {{2, 900'020}, {4, 900'040}}});
    const FlowFinding flow = check_flows(files_).at(0);
    EXPECT_EQ(flow.lost, 1U);
    EXPECT_EQ(flow.outside, 2U);
}

TEST_F(LogTools, WhatNobodySentIsForeign) {
    add("master", {.messages = {{1, 10}, {3, 30}}});
    add("slave", {.direction = "received", .messages = {{1, 11}, {2, 21}, {3, 31}}});
    EXPECT_EQ(check_flows(files_)[0].foreign, 1U);
}

// In lock-step each begins anew: with the same instances, sequences and times.
class TrialsOfLockStep : public LogTools {
  protected:
    TrialsOfLockStep() {
        add_trial("50ms_trial01", {{1, 11}, {3, 31}});
        add_trial("50ms_trial02_repaired", {{1, 11}, {2, 21}, {3, 31}});
    }
    void add_trial(const std::string& name, const std::vector<WrittenMessage>& received) {
        add("thimble-master_" + name, {.messages = {{1, 10}, {2, 20}, {3, 30}}});
        add("thimble-slave-sim_" + name, {.direction = "received", .messages = received});
    }
};

TEST_F(TrialsOfLockStep, AreCheckedEachWithItself) {
    const FlowFinding flow = check_flows(files_).at(0);
    EXPECT_EQ(flow.received, 5U);
    EXPECT_EQ(flow.lost, 1U);
    EXPECT_EQ(flow.repeated, 0U);
}

TEST_F(TrialsOfLockStep, AreNeverMerged) {
    EXPECT_THAT(refusal([&] { merge_logs(files_); }, ExitCode::kUsage), HasSubstr("/*_50ms_trial01.mcap"));
    EXPECT_THROW(export_ros2(files_, folder_ / "ros2.mcap", ""), Error);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "ros2.mcap"));
    files_.resize(2);
    EXPECT_THAT(merge_logs(files_), SizeIs(5));
}

// 1000 sent, 700 received; `lost` is what the relay names of the 300.
std::string needle_link_report(int lost, int delivered) {
    nlohmann::json link{{"pushed", 1000}, {"delivered", delivered}, {"lost", lost},
                        {"outage", 0},    {"queue_full", 10},       {"overflowed", 0},
                        {"oversized", 0}, {"duplicated", 0},        {"corrupted", 0}};
    return nlohmann::json{{"links", {link, link, link, link}}}.dump();
}

TEST_F(LogTools, WhatIsLostHasANameInTheRelaysReport) {
    FlowFinding flow;
    flow.topic = "/master/needle_command";
    flow.sent = 1000;
    flow.received = 700;
    flow.lost = 300;
    const auto report = folder_ / "thimble-netem_0ms.json";
    const auto problem_with = [&](const std::string& text) {
        std::ofstream(report) << text;
        const auto findings = check_relay({flow}, report);
        return findings.size() == 1 ? findings.front().problem : "not one finding";
    };
    EXPECT_EQ(problem_with(needle_link_report(290, 700)), "");
    EXPECT_EQ(check_relay({flow}, report).front().names, "290 lost, 10 queue_full");
    EXPECT_THAT(problem_with(needle_link_report(90, 700)),
                HasSubstr("200 packets are neither delivered nor counted as lost"));
    EXPECT_THAT(problem_with(needle_link_report(90, 900)),
                HasSubstr("200 packets were lost after the relay"));
    EXPECT_THAT(problem_with(needle_link_report(390, 700)), HasSubstr("-100 packets are neither"));
    flow.sent = 1200;
    EXPECT_THAT(problem_with(needle_link_report(290, 700)), HasSubstr("200 packets were lost before"));
    EXPECT_THAT(check_relay({}, report), IsEmpty());
    EXPECT_THROW(problem_with("{}"), Error);
}

TEST_F(LogTools, MergesOnTheSessionsClock) {
    add("master", {.boot = "another machine", .messages = {{1, 1'000'000'010}, {2, 1'000'000'030}}});
    add("session", {.program = "session",
                    .direction = "received",
                    .messages = {{1, 20}, {2, 40}},
                    .more = [](McapWriter& writer) { say_master_is_ahead(writer, "1.0"); }});
    std::vector<std::int64_t> times;
    for (const MergedMessage& m : merge_logs(files_)) times.push_back(m.session_time_ns);
    EXPECT_THAT(times, ElementsAre(10, 20, 30, 40));
}

TEST_F(LogTools, OneMachineHasOneClock) {
    add("master", {.messages = {{1, 15}}});
    add("session", {.program = "session", .messages = {{1, 20}}, .more = [](McapWriter& writer) {
                        say_master_is_ahead(writer, "0.5");
                    }});
    EXPECT_EQ(merge_logs(files_).front().session_time_ns, 15);
}

// Every kind of message has its columns and its object, and no field is missing.
TEST_F(LogTools, EveryKindIsExported) {
    const LoggedFile& file = add("all", {.messages = {{1, 10}}, .bodies = sample_messages()});
    const PacketFields fields;
    std::set<std::string> kinds;
    for (const MergedMessage& m : merge_logs(files_)) {
        const auto object = nlohmann::json::parse(to_json(m, fields));
        for (const PacketPart& kind : fields.kinds()) {
            if (!object.contains(kind.name)) continue;
            kinds.insert(kind.name);
            EXPECT_EQ(object[kind.name].size(), kind.fields.size()) << kind.name;
        }
    }
    EXPECT_EQ(kinds.size(), std::variant_size_v<Body>);
    EXPECT_EQ(export_csv(files_, folder_ / "tables", ""), std::variant_size_v<Body>);
    EXPECT_THAT(
        read_text(folder_ / "tables" / "all.master.needle_command.needle_command.csv"),
        HasSubstr("log_time_ns,publish_time_ns,direction,header_instance,header_send_time_ns,header_sequence,"
                  "header_trial,header_sender,position_needle_m,velocity_needle_m_per_s"));
    EXPECT_EQ(file.topics().size(), 1U);
}

// As the sessions of two runs leave them.
class LogsOfOneName : public LogTools {
  protected:
    LogsOfOneName() {
        for (const char* run : {"a", "b"}) {
            std::filesystem::create_directories(folder_ / run / "nodes");
            paths_.push_back((folder_ / run / "nodes/master_50ms.mcap").string());
            WrittenLog log;
            log.messages = {{1, run[0] == 'a' ? 10 : 20}};
            log.write(paths_.back());
        }
    }
    std::vector<std::string> paths_;
};

TEST_F(LogsOfOneName, HaveTablesOfTheirOwn) {
    const auto tables = folder_ / "tables";
    EXPECT_EQ(export_csv(open_logs(paths_), tables, ""), 2U);
    for (const auto& [run, time] : {std::pair{"a", "\n10,"}, std::pair{"b", "\n20,"}}) {
        const std::string text = read_text(
            tables / fmt::format("{}.nodes.master_50ms.master.needle_command.needle_command.csv", run));
        EXPECT_THAT(text, HasSubstr(time));
        EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2) << text;
    }
}

TEST_F(LogsOfOneName, AreToldApartByNoMoreThanItTakes) {
    WrittenLog{}.write(folder_ / "a/nodes/session.mcap");
    WrittenLog{}.write(folder_ / "a/nodes/master_50ms.repaired");
    paths_.push_back((folder_ / "a/nodes/session.mcap").string());
    paths_.push_back((folder_ / "a/../a/nodes/master_50ms.repaired").string());
    std::vector<std::string> names;
    for (const auto& file : open_logs(paths_)) names.push_back(file->name());
    EXPECT_THAT(names, ElementsAre("a/nodes/master_50ms.mcap", "b/nodes/master_50ms", "session",
                                   "a/nodes/master_50ms.repaired"));
    paths_.push_back(folder_ / "b/./nodes/master_50ms.mcap");
    EXPECT_THROW(open_logs(paths_), Error);
}

TEST_F(LogsOfOneName, AreNeverMerged) {
    for (const std::string& path : paths_) files_.push_back(std::make_unique<LoggedFile>(path));
    EXPECT_THROW(export_csv(files_, folder_ / "tables", ""), Error);
    EXPECT_THROW(export_hdf5(files_, folder_ / "all.h5", ""), Error);
}

TEST_F(LogTools, ValuesAreThoseThatWereSent) {
    ForceFeedback body;
    body.force_tissue_N = -1.25;
    body.hold_time = Duration{42};
    body.phase = TissuePhase::kPenetrated;
    body.needle_held = true;
    add("slave", {.messages = {{1, 10}}, .bodies = {Message{{7, {}, 0, 3, Role::kSlaveSim}, body}}});
    const auto object = nlohmann::json::parse(to_json(merge_logs(files_)[0], PacketFields{}));
    EXPECT_EQ(object["force_feedback"]["force_tissue_N"], -1.25);
    EXPECT_EQ(object["force_feedback"]["hold_time_ns"], 42);
    EXPECT_EQ(object["force_feedback"]["phase"], "Penetrated");
    EXPECT_EQ(object["force_feedback"]["needle_held"], true);
    EXPECT_EQ(object["header"]["trial"], 3);
    EXPECT_EQ(object["header"]["sender"], "SlaveSim");
}

// In a column of names, a number would be of another type.
TEST_F(LogTools, AnEnumValueWithoutANameIsATextToo) {
    ForceFeedback body;
    body.phase = static_cast<TissuePhase>(7);
    add("slave", {.messages = {{1, 10}}, .bodies = {Message{{7, {}, 0, 3, Role::kSlaveSim}, body}}});
    const auto object = nlohmann::json::parse(to_json(merge_logs(files_)[0], PacketFields{}));
    EXPECT_EQ(object["force_feedback"]["phase"], "7");
}

TEST_F(LogTools, EveryKindIsInTheHdf5File) {
    add("all", {.messages = {{1, 10}, {2, 20}}, .bodies = sample_messages()});
    const auto path = folder_ / "all.h5";
    EXPECT_EQ(export_hdf5(files_, path, ""), std::variant_size_v<Body>);
    const std::string text = read_text(path);
    EXPECT_EQ(text.substr(1, 3), "HDF");
    EXPECT_THAT(text, HasSubstr("velocity_needle_m_per_s"));
    EXPECT_THAT(text, HasSubstr("0 Free, 1 Contact, 2 Penetrated"));
    EXPECT_THROW(export_hdf5(files_, path, ""), Error);
    EXPECT_EQ(read_text(path), text);
}

TEST_F(LogTools, RepairGivesAWholeFile) {
    const LoggedFile& whole = add("master", {.messages = {{1, 10}, {2, 20}, {3, 30}}});
    const auto cut = folder_ / "cut.mcap", repaired = folder_ / "repaired.mcap";
    std::filesystem::copy_file(whole.path(), cut);
    std::filesystem::resize_file(cut, whole.scan().whole_bytes - 700);
    const RepairResult result = repair_log(cut, repaired);
    EXPECT_FALSE(result.scan.finished);
    const LoggedFile file(repaired);
    EXPECT_TRUE(file.scan().finished);
    EXPECT_EQ(file.scan().messages, result.messages);
    EXPECT_EQ(file.value("thimble", "program"), "thimble-master");
    EXPECT_THROW(repair_log(cut, repaired), Error);
}

TEST(LogFiles, WhatIsNoLogIsRefusedWithItsName) {
    const TemporaryDirectory folder;
    const auto path = folder / "trials.csv";
    for (const char* text : {"", "experiment,subject\n", "\x89MCAP0\r\n"}) {
        write_text_file(path, text);
        EXPECT_THAT(refusal([&] { LoggedFile file(path); }), HasSubstr("trials.csv")) << text;
    }
    EXPECT_THROW(LoggedFile(folder.path()), Error);
    EXPECT_THROW(LoggedFile(folder / "none"), Error);
}

TEST(LogTopics, BothSidesOfTheRelayHaveOneName) {
    EXPECT_STREQ(flow(Port::kNetemNeedle).topic, "/master/needle_command");
    for (const auto& [before, behind] : {std::pair{Port::kNetemNeedle, Port::kSlaveNeedle},
                                         std::pair{Port::kNetemForceMaster, Port::kMasterForce},
                                         std::pair{Port::kNetemForceCutaneous, Port::kCutaneousForce},
                                         std::pair{Port::kNetemForceVisual, Port::kVisualForce}}) {
        EXPECT_STREQ(flow(before).topic, flow(behind).topic);
    }
}

// Each is named after its sender. Where netem sends, after the sender to netem.
TEST(LogTopics, AreNamedAfterTheirSpeakers) {
    for (const Port port : kEveryPort) {
        const std::string topic = flow(port).topic;
        if (flow(port).hears == Role::kNetem && flow(port).listens != Role::kSession) continue;
        if (flow(port).from_all) continue;  // stop buses: after the receiver
        EXPECT_THAT(topic, testing::StartsWith(std::string("/") + to_string(flow(port).hears) + "/"));
    }
}

TEST(LogUnits, AreInTheNames) {
    EXPECT_EQ(unit_of("velocity_needle_m_per_s"), "m/s");
    EXPECT_EQ(unit_of("change_s_3"), "s");
    EXPECT_EQ(unit_of("force_hand_N"), "N");
    EXPECT_EQ(unit_of("trial"), "");
}

// With many chunks the index leaves memory: the file has the same bytes as with an index in memory.
TEST(LogFiles, ALongIndexIsSetAside) {
    const auto write = [](McapSink& sink) {
        McapWriter writer(sink, "test");
        const std::uint16_t channel = writer.add_channel(0, "/a", "", {});
        std::size_t most = 0;
        for (std::uint32_t i = 0; i < 3000; ++i) {
            writer.add_message({channel, i, i, i, {}});
            writer.flush();
            most = std::max(most, writer.index_bytes());
        }
        writer.finish();
        return most;
    };
    const TemporaryDirectory folder;
    MemorySink memory;
    EXPECT_GT(write(memory), 3 * McapWriter::kLongIndexBytes);
    std::size_t most = 0;
    {
        LogFile file(folder / "long.mcap");
        most = write(file);
    }
    EXPECT_LT(most, 2 * McapWriter::kLongIndexBytes);
    const std::string bytes = read_text(folder / "long.mcap");
    EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), memory.bytes.begin(), memory.bytes.end(),
                           [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; }));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1)
        << "nothing else is left";
}

}  // namespace
}  // namespace thimble
