// The order of a participant: drawn once, written, read back.
#include "session/participant/order_file.hpp"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "session/settings/protocol.hpp"
#include "session/settings/system_settings.hpp"
#include "tests/unit/participant/short_sessions.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

SystemSettings paper_session() {
    return read_system_settings(
        ConfigFile::parse("[protocol]\nexperiments = [1, 2]\nbreak_every = 13\n", "session.toml"));
}

void expect_same(const TrialConditions& a, const TrialConditions& b) {
    EXPECT_EQ(a.trial, b.trial);
    EXPECT_EQ(a.experiment, b.experiment);
    EXPECT_EQ(a.modality, b.modality);
    EXPECT_EQ(a.fixture_position_m, b.fixture_position_m);
}

TEST(OrderFile, ThePapersFirstSession) {
    const auto order = plan_order(paper_session(), 7);
    ASSERT_EQ(order.size(), 4U + 24 + 2);
    std::set<std::pair<std::uint32_t, std::uint32_t>> keys;
    for (std::size_t i = 0; i < order.size(); ++i) {
        EXPECT_EQ(order[i].position, i + 1);
        EXPECT_EQ(order[i].practice, i < 4);
        EXPECT_EQ(order[i].block, i < 4 ? 0U : i < 17 ? 1U : 2U);
        EXPECT_EQ(order[i].conditions.subject, 7U);
        EXPECT_EQ(order[i].conditions.removes_fixture, i == 4 + 12 || i == 4 + 25);
        keys.insert({order[i].conditions.experiment, order[i].conditions.trial});
    }
    EXPECT_EQ(keys.size(), order.size()) << "no trial of one experiment has the number of another";
}

TEST(OrderFile, PracticeChangesNoOtherTrial) {
    const auto with = plan_order(short_settings(), 2);
    SystemSettings settings = short_settings();
    settings.protocol->practice_trials = 0;
    const auto without = plan_order(settings, 2);
    ASSERT_EQ(with.size(), without.size() + 1);
    for (std::size_t i = 0; i < without.size(); ++i)
        expect_same(with[i + 1].conditions, without[i].conditions);
}

TEST(OrderFile, AgreesWithTheStudy) {
    const SystemSettings settings = paper_session();
    const auto order = plan_order(settings, 3);
    auto study = all_trials({experiment_1(settings, 16, 1), experiment_2(settings, 16, 1)});
    std::erase_if(study, [](const TrialConditions& c) { return c.subject != 3; });
    ASSERT_EQ(study.size() + 4, order.size());
    for (std::size_t i = 0; i < study.size(); ++i) expect_same(order[i + 4].conditions, study[i]);
}

TEST(OrderFile, ComesBackToTheBit) {
    const TemporaryDirectory folder;
    const auto order = plan_order(paper_session(), 7);
    write_order(folder / "orders/sub-07_order.tsv", order);
    EXPECT_EQ(difference(read_order(folder / "orders/sub-07_order.tsv", 7), order), "");
}

TEST(OrderFile, SaysWhatDiffers) {
    const auto order = plan_order(paper_session(), 7);
    auto other = order;
    other[20].conditions.modality =
        other[20].conditions.modality == Modality::kHF ? Modality::kCF : Modality::kHF;
    EXPECT_THAT(difference(order, other), HasSubstr("position 21 modality is"));
    EXPECT_EQ(difference(order, other, true), "it differs at position 21");
    other = order;
    other.pop_back();
    EXPECT_THAT(difference(order, other), HasSubstr("30 trials, the settings give 29"));
    EXPECT_NE(difference(order, plan_order(paper_session(), 8)), "");
}

TEST(OrderFile, DamageIsNamedWithItsLine) {
    const TemporaryDirectory folder;
    const auto file = folder / "order.tsv";
    write_order(file, plan_order(short_settings(), 1));
    const std::string text = read_text(file);
    for (const auto& [from, to] : {std::pair{"HF", "XF"}, {"\n2\t", "\n9\t"}, {"position", "place"}}) {
        std::string damaged = text;
        damaged.replace(damaged.find(from), std::string(from).size(), to);
        write_text(file, damaged);
        EXPECT_THAT(refusal([&] { read_order(file, 1); }), HasSubstr("order.tsv:")) << from;
    }
}

TEST(OrderFile, NobodyBeyondThePlan) {
    EXPECT_NO_THROW(plan_order(short_settings(), 4));
    EXPECT_THROW(plan_order(short_settings(), 5), Error);
    EXPECT_THROW(plan_order(SystemSettings{}, 1), Error);
}

// [protocol], [dataset] and whom the session is with.
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
    for (const char* mixed : {"[1, 3]", "[2, 1]", "[]", "[1.5]", "[4]", "[1, 1]", "3"})
        EXPECT_THROW(read(std::string("[protocol]\nexperiments = ") + mixed), Error) << mixed;
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
    for (const char* wrong : {"", "P", "P0", "P-1", "7", "P7x", "Paul", "p07", "P07 ", "P1000001", "sub-"})
        EXPECT_FALSE(parse_participant(wrong).has_value()) << wrong;
    EXPECT_EQ(participant_id(7), "sub-07");
    EXPECT_EQ(participant_id(123), "sub-123");
}

}  // namespace
}  // namespace thimble
