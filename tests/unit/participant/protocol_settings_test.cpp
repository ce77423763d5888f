// [protocol], [dataset] and whom the session is with.
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {
namespace {

SystemSettings read(const std::string& text) {
    return read_system_settings(ConfigFile::parse(text, "session.toml"));
}

TEST(ProtocolSettingsTest, WithoutTheTableThereIsNoProtocol) {
    EXPECT_FALSE(read("").protocol.has_value());
    ASSERT_TRUE(read("[protocol]").protocol.has_value());
    EXPECT_EQ(read("[protocol]").protocol->experiments, std::vector<std::uint32_t>{3});
}

TEST(ProtocolSettingsTest, AsManySubjectsAsThePaperUnlessSaid) {
    EXPECT_EQ(read("[protocol]").protocol->subjects, 10U);
    EXPECT_EQ(read("[protocol]\nexperiments = [1, 2]").protocol->subjects, 16U);
    EXPECT_EQ(read("[protocol]\nsubjects = 3").protocol->subjects, 3U);
}

TEST(ProtocolSettingsTest, AParticipantSessionHasOneDelay) {
    for (const char* mixed : {"[1, 3]", "[2, 1]", "[]", "[1.5]", "[4]", "[1, 1]", "3"}) {
        EXPECT_THROW(read(std::string("[protocol]\nexperiments = ") + mixed), Error) << mixed;
    }
}

TEST(ProtocolSettingsTest, WhoItIsWith) {
    const SystemSettings human = read("[session]\nsubject = 'human'\nparticipant = 'P07'");
    EXPECT_EQ(human.plan.kind, SubjectKind::kHuman);
    EXPECT_EQ(human.plan.subject, 7U);
    EXPECT_EQ(read("[session]\nsubject = 'human'").plan.subject, 0U);
    EXPECT_EQ(read("[session]\nsubject = 7").plan.kind, SubjectKind::kVirtual);
    for (const char* wrong : {"subject = 'Anna'", "subject = 'human'\nparticipant = 'Anna'", "subject = 0",
                              "subject = 'human'\nparticipant = 7", "participant = 'P07'"}) {
        EXPECT_THROW(read(std::string("[session]\n") + wrong), Error) << wrong;
    }
}

TEST(ProtocolSettingsTest, WhoBeginsATrial) {
    EXPECT_FALSE(read("[protocol]").protocol->subject_goes_on);
    const SystemSettings subject = read("[handle]\ndevice = 'pointer'\n[protocol]\nnext_by = 'subject'");
    EXPECT_TRUE(subject.protocol->subject_goes_on);
    EXPECT_TRUE(subject.visual.subject_goes_on) << "the same value, for the window";
    EXPECT_TRUE(subject.visual.pointer);
    EXPECT_THROW(read("[protocol]\nnext_by = 'both'"), Error);
    EXPECT_THROW(read("[instructions]\nwelcom = ''"), Error);
}

TEST(ProtocolSettingsTest, TheOperatorKnowsItsInstruments) {
    for (const char* two : {"[master]\nposition_scale = 2", "[visual]\nbar_full_scale_N = 10",
                            "[cutaneous]\nforce_limit_N = 1", "[operator]\nposition_scale = 2"}) {
        EXPECT_THROW(read(two), Error) << two;
    }
    EXPECT_NO_THROW(read("[master]\nposition_scale = 2\n[operator]\nposition_scale = 2"));
}

TEST(ProtocolSettingsTest, ParticipantsAreNumbersOnly) {
    EXPECT_EQ(parse_participant("P07"), 7U);
    EXPECT_EQ(parse_participant("sub-123"), 123U);
    for (const char* wrong : {"", "P", "P0", "P-1", "7", "P7x", "Paul", "p07", "P07 ", "P1000001", "sub-"}) {
        EXPECT_FALSE(parse_participant(wrong).has_value()) << wrong;
    }
    EXPECT_EQ(participant_id(7), "sub-07");
    EXPECT_EQ(participant_id(123), "sub-123");
}

}  // namespace
}  // namespace thimble
