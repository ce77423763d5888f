// MCAP: what is written is read; what was cut off or damaged is read as far as it is whole.
#include <algorithm>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "common/error.hpp"
#include "tests/fuzz/checks.hpp"
#include "tests/unit/log/small_log.hpp"
#include "thimble/log/log_tools.hpp"

namespace thimble {

void MemorySink::write(Bytes more) {
    if (bytes.size() + more.size() > room) throw Error(ExitCode::kRunFailed, "full");
    bytes.insert(bytes.end(), more.begin(), more.end());
}

void SaidByLog::schema(const McapSchema& s) {
    lines.push_back(fmt::format("schema {} {} {}", s.name, s.encoding, s.data.size()));
}
void SaidByLog::channel(const McapChannel& c) {
    lines.push_back(fmt::format("channel {} {} {}", c.topic, c.encoding, value_of(c.metadata, "direction")));
}
void SaidByLog::message(const McapMessage& m) {
    messages.push_back(fmt::format("{} #{} {} {} {}", m.channel, m.sequence, m.log_time_ns, m.publish_time_ns,
                                   std::string(m.data.begin(), m.data.end())));
}
void SaidByLog::metadata(const McapMetadata& m) {
    lines.push_back(fmt::format("metadata {}", m.name));
    for (const auto& [key, value] : m.pairs) lines.push_back(fmt::format("{} = {}", key, value));
}
void SaidByLog::attachment(const McapAttachment& a) {
    lines.push_back(fmt::format("attachment {} {} {}", a.name, a.media_type, a.data.size()));
}

Bytes letters(std::string_view text) {
    return {static_cast<const std::uint8_t*>(static_cast<const void*>(text.data())), text.size()};
}

std::vector<std::uint8_t> small_log() {
    MemorySink sink;
    McapWriter writer(sink, "test");
    const std::uint16_t schema = writer.add_schema("Packet", "flatbuffer", letters("abc"));
    writer.add_metadata("thimble", {{"program", "test"}, {"version", "1"}});
    writer.add_attachment({7, "session.toml", "application/toml", letters("[session]")});
    const std::uint16_t a = writer.add_channel(schema, "/a", "flatbuffer", {{"direction", "sent"}});
    const std::uint16_t b = writer.add_channel(0, "/b", "", {{"direction", "received"}});
    for (std::uint32_t i = 0; i < 6; ++i) {
        const std::string text = fmt::format("message {}", i);
        writer.add_message({i % 3 == 0 ? b : a, i, 100 + i, 50 + i, letters(text)});
        if (i == 3) writer.flush();
    }
    writer.finish();
    return sink.bytes;
}

namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TEST(Mcap, WhatIsWrittenIsRead) {
    const auto file = small_log();
    SaidByLog said;
    const McapScan scan = scan_mcap(file, said);
    EXPECT_TRUE(scan.finished);
    EXPECT_THAT(scan.flaws, IsEmpty());
    EXPECT_EQ(scan.whole_bytes + kMcapMagic.size(), file.size());
    EXPECT_EQ(scan.chunks, 2U);
    EXPECT_THAT(said.lines,
                ElementsAre("test", "schema Packet flatbuffer 3", "metadata thimble", "program = test",
                            "version = 1", "attachment session.toml application/toml 9",
                            "channel /a flatbuffer sent", "channel /b  received"));
    EXPECT_THAT(said.messages,
                ElementsAre("1 #0 100 50 message 0", "0 #1 101 51 message 1", "0 #2 102 52 message 2",
                            "1 #3 103 53 message 3", "0 #4 104 54 message 4", "0 #5 105 55 message 5"));
}

// A power cut: the file ends anywhere. Every message that ends before that is there, in the repaired file as well.
TEST(Mcap, CutAtEveryByteItGivesEveryWholeMessage) {
    const auto file = small_log();
    SaidByLog whole;
    scan_mcap(file, whole);
    const std::string text(file.begin(), file.end());
    for (std::size_t size = 0; size <= file.size(); ++size) {
        SaidByLog said, repaired;
        const McapScan scan = scan_mcap(Bytes(file).first(size), said);
        std::size_t expected = 0;
        while (expected < 6 && text.find(fmt::format("message {}", expected)) + 9 <= size) ++expected;
        ASSERT_THAT(said.messages, SizeIs(expected)) << size;
        ASSERT_TRUE(std::equal(said.messages.begin(), said.messages.end(), whole.messages.begin())) << size;
        ASSERT_EQ(scan.finished, size == file.size()) << size;
        ASSERT_LE(scan.whole_bytes, size);
        MemorySink sink;
        McapWriter writer(sink, "test");
        copy_whole_records(Bytes(file).first(size), writer);
        writer.finish();
        ASSERT_TRUE(scan_mcap(sink.bytes, repaired).finished) << size;
        ASSERT_THAT(repaired.messages, SizeIs(expected)) << size;
    }
}

// A power cut may also leave zeros behind what was written.
TEST(Mcap, ZerosAtTheEndAreNoRecords) {
    auto file = small_log();
    file.resize(file.size() - 8);
    file.resize(file.size() + 4096);
    SaidByLog said;
    EXPECT_FALSE(scan_mcap(file, said).finished);
    EXPECT_THAT(said.messages, SizeIs(6));
}

// Every bit of a chunk is under a CRC: nothing wrong is ever given out.
TEST(Mcap, AFlippedBitIsNeverBelieved) {
    const auto file = small_log();
    SaidByLog whole;
    scan_mcap(file, whole);
    const std::string text(file.begin(), file.end());
    const std::size_t first = text.find("message 0"), last = text.find("message 3") + 9;
    for (std::size_t bit = 8 * first; bit < 8 * last; ++bit) {
        auto flipped = file;
        flipped[bit / 8] = static_cast<std::uint8_t>(flipped[bit / 8] ^ (1U << (bit % 8)));
        SaidByLog said;
        ASSERT_EQ(scan_mcap(flipped, said).damaged, 2U) << bit;  // the chunk, and the data section as a whole
        ASSERT_THAT(said.messages, ElementsAre(whole.messages[4], whole.messages[5])) << bit;
    }
}

TEST(Mcap, ADamagedAttachmentAndSummaryAreTold) {
    auto file = small_log();
    const std::string text(file.begin(), file.end());
    file[text.find("[session]")] ^= 1U;
    file[text.rfind("/b")] ^= 1U;
    SaidByLog said;
    const McapScan scan = scan_mcap(file, said);
    EXPECT_THAT(scan.flaws, ElementsAre(HasSubstr("an attachment"), HasSubstr("the data section"),
                                        HasSubstr("the summary")));
    EXPECT_THAT(said.messages, SizeIs(6));
}

TEST(Mcap, AFullDiskLosesTheChunkAndNothingElse) {
    MemorySink sink;
    McapWriter writer(sink, "test");
    const std::uint16_t channel = writer.add_channel(0, "/a", "", {});
    const auto add = [&](std::uint32_t i) { writer.add_message({channel, i, i, i, letters("0123456789")}); };
    add(1);
    writer.flush();
    sink.room = sink.bytes.size() + 20;
    add(2);
    EXPECT_THROW(writer.flush(), Error);
    EXPECT_EQ(writer.forgotten(), 1U);
    sink.room = SIZE_MAX;
    add(3);
    writer.finish();
    SaidByLog said;
    EXPECT_TRUE(scan_mcap(sink.bytes, said).finished);
    EXPECT_THAT(said.messages, ElementsAre(HasSubstr("#1"), HasSubstr("#3")));
}

TEST(Mcap, AnythingIsReadWithoutHarm) {
    EXPECT_TRUE(rc::check("bytes of all kinds behind a good beginning",
                          [](const std::vector<std::uint8_t>& tail, std::uint16_t at) {
                              auto file = small_log();
                              const std::size_t place = at % file.size();
                              std::copy_n(tail.begin(), std::min(tail.size(), file.size() - place),
                                          file.begin() + static_cast<std::ptrdiff_t>(place));
                              const std::string flaw = check_log(file).flaw;
                              if (!flaw.empty()) RC_FAIL(flaw);
                          }));
}

}  // namespace
}  // namespace thimble
