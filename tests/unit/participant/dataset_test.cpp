// One folder holds virtual or human data, never both, and nothing else.
#include "session/participant/dataset.hpp"

#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/version.hpp"
#include "session/participant/corrections.hpp"
#include "session/participant/record_table.hpp"
#include "tests/unit/participant/short_sessions.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

void expect_refused(const std::function<void()>& what, ExitCode code, const std::string& words) {
    EXPECT_THAT(refusal(what, code), HasSubstr(words));
}

TEST(Dataset, VirtualAndHumanDataNeverShareAFolder) {
    for (const SubjectKind kind : {SubjectKind::kVirtual, SubjectKind::kHuman}) {
        const TemporaryDirectory parent;
        const Dataset dataset(parent / "new");
        EXPECT_FALSE(dataset.kind().has_value());
        dataset.open(kind, {});
        EXPECT_EQ(dataset.kind(), kind);
        dataset.open(kind, {});
        const SubjectKind other = kind == SubjectKind::kHuman ? SubjectKind::kVirtual : SubjectKind::kHuman;
        expect_refused([&] { dataset.open(other, {}); }, ExitCode::kUsage, "--out");
        expect_refused([&] { refuse_dataset(dataset.folder()); }, ExitCode::kUsage, to_string(kind));
    }
}

TEST(Dataset, NothingElseIsTurnedIntoOne) {
    for (const char* name : {"trials.csv", "README.md"}) {
        const TemporaryDirectory folder;
        write_text(folder / name, "of somebody else\n");
        const Dataset dataset(folder.path());
        refuse_dataset(folder.path());  // not a dataset: fine
        expect_refused([&] { dataset.open(SubjectKind::kHuman, {}); }, ExitCode::kUsage, "empty folder");
        EXPECT_FALSE(std::filesystem::exists(dataset.description()));
        EXPECT_EQ(read_text(folder / name), "of somebody else\n");
    }
}

TEST(Dataset, ACrashWhileItWasMadeDoesNoHarm) {
    const TemporaryDirectory folder;
    const Dataset dataset(folder.path());
    std::ofstream(dataset.description().string() + ".new") << "{ \"Na";
    dataset.open(SubjectKind::kHuman, {});
    EXPECT_EQ(dataset.kind(), SubjectKind::kHuman);
}

// The description comes last: a folder that is a dataset has all its sidecars, and one that is none yet can become one.
TEST(Dataset, ACrashBeforeTheDescriptionDoesNoHarm) {
    const TemporaryDirectory folder;
    const Dataset dataset(folder.path());
    const std::filesystem::path in_the_way = dataset.description().string() + ".new";
    std::filesystem::create_directory(in_the_way);
    EXPECT_THROW(dataset.open(SubjectKind::kHuman, {}), Error);
    for (const char* file : {"participants.json", "task-needle_beh.json", "README.md", ".bidsignore"})
        EXPECT_TRUE(std::filesystem::exists(folder / file)) << file;
    EXPECT_FALSE(dataset.kind().has_value());
    std::filesystem::remove(in_the_way);
    std::ofstream(folder / "README.md.new") << "half";
    dataset.open(SubjectKind::kHuman, {});
    EXPECT_EQ(dataset.kind(), SubjectKind::kHuman);
}

TEST(Dataset, ADescriptionThatDoesNotSayWhoseDataIsNotTrusted) {
    const TemporaryDirectory folder;
    const Dataset dataset(folder.path());
    for (const char* text : {"", "{", "[]", "{}", R"({"SubjectKind": "robot"})", R"({"SubjectKind": 1})"}) {
        std::ofstream(dataset.description()) << text;
        expect_refused([&] { static_cast<void>(dataset.kind()); }, ExitCode::kData, "SubjectKind");
    }
}

TEST(Dataset, DescriptionAsBidsWantsIt) {
    const TemporaryDirectory parent;
    const Dataset dataset(parent / "d");
    dataset.open(SubjectKind::kHuman, {"A study", "CC0", {"A. Author"}, {"Board 12"}});
    const auto json = nlohmann::json::parse(read_text(dataset.description()));
    EXPECT_EQ(json.at("Name"), "A study");
    EXPECT_EQ(json.at("DatasetType"), "raw");
    EXPECT_EQ(json.at("License"), "CC0");
    EXPECT_EQ(json.at("Authors").at(0), "A. Author");
    EXPECT_EQ(json.at("EthicsApprovals").at(0), "Board 12");
    EXPECT_EQ(json.at("GeneratedBy").at(0).at("Name"), "Thimble");
    EXPECT_EQ(json.at("GeneratedBy").at(0).at("Version"), std::string(kVersion));
    EXPECT_TRUE(json.contains("BIDSVersion"));
}

TEST(Dataset, EveryColumnIsExplained) {
    const TemporaryDirectory parent;
    Dataset(parent / "d").open(SubjectKind::kVirtual, {});
    const auto json = nlohmann::json::parse(read_text(parent / "d/task-needle_beh.json"));
    for (const std::string_view column : record_columns()) EXPECT_TRUE(json.contains(column)) << column;
    EXPECT_EQ(json.size(), record_columns().size() + 2);  // TaskName and TaskDescription, nothing stale
    const auto people = nlohmann::json::parse(read_text(parent / "d/participants.json"));
    EXPECT_THAT(people["consent"]["Description"].get<std::string>(),
                AllOf(HasSubstr("as the experimenter stated, or at the screen"), HasSubstr("consent.tsv")));
}

// Tables of a dataset: what is written comes back, what is there is never altered, half a line does no harm.
void append_text(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary | std::ios::app) << text;
}

TEST(RecordTable, ComesBack) {
    const TemporaryDirectory folder;
    const auto order = plan_order(short_settings(), 1);
    const auto file = folder / "sub-01/beh/table.tsv";
    EXPECT_TRUE(read_records(file).empty());
    {
        RecordTable table(file);
        table.append(record_of(order[1], 1, EndReason::kPeerLost));
        DatasetRecord repeat = record_of(order[1], 2, EndReason::kCompleted, 1);
        repeat.repeat_reason = "peer_lost_visual\tand\nmore";
        repeat.number = 17;
        repeat.row.metrics.penetration_max_m = 1.0 / 3;
        table.append(repeat);
    }
    const auto records = read_records(file);
    ASSERT_EQ(records.size(), 2U);
    EXPECT_EQ(records[0].row.reason, EndReason::kPeerLost);
    EXPECT_EQ(records[0].row.lost_peer, Role::kVisual);
    EXPECT_EQ(records[0].repeat_of, 0U);
    EXPECT_TRUE(std::isnan(records[0].row.metrics.penetration_max_m));
    EXPECT_EQ(records[1].repeat_of, 1U);
    EXPECT_EQ(records[1].repeat_reason, "peer_lost_visual and more");
    EXPECT_EQ(records[1].number, 17U);
    EXPECT_EQ(records[1].row.metrics.penetration_max_m, 1.0 / 3);
    EXPECT_EQ(records[1].row.conditions.fixture_position_m, order[1].conditions.fixture_position_m);
    EXPECT_THAT(read_text(file), Not(HasSubstr("\t\t")));  // BIDS: n/a, never nothing
}

TEST(RecordTable, HalfALineIsCutOffAndItsTrialRunAgain) {
    const TemporaryDirectory folder;
    const auto order = plan_order(short_settings(), 1);
    const auto file = folder / "table.tsv";
    {
        RecordTable table(file);
        table.append(record_of(order[0], 1));
        table.append(record_of(order[1], 2));
    }
    const std::string whole = read_text(file);
    for (const std::size_t cut : {std::size_t{0}, std::size_t{5}, whole.find('\n') + 1, whole.size() - 1}) {
        std::filesystem::resize_file(file, cut);
        {
            RecordTable table(file);
            for (auto i = read_records(file).size(); i < 2; ++i)
                table.append(record_of(order[i], static_cast<std::uint32_t>(i + 1)));
        }
        EXPECT_EQ(read_text(file), whole) << cut;
    }
    append_text(file, "not a record\n");
    EXPECT_THROW(read_records(file), Error);
}

TEST(RecordTable, AnotherTableKeepsEveryByte) {
    const TemporaryDirectory folder;
    const auto file = folder / "table.tsv";
    for (const std::string& text : {std::string("a note"), std::string("name\tnote\nsub-01\tkept as it")}) {
        std::ofstream(file, std::ios::binary) << text;
        EXPECT_THROW(RecordTable{file}, Error);
        EXPECT_EQ(read_text(file), text);
    }
}

TEST(Exclusions, ComeBackWithTheirReason) {
    const TemporaryDirectory folder;
    const auto file = folder / "exclusions.tsv";
    EXPECT_TRUE(read_exclusions(file).empty());
    add_exclusion(file, {7, 12, 13, ExclusionKind::kRejected, "hand\tslipped\n"});
    append_text(file, "sub-07\t12");  // killed here
    add_exclusion(file, {7, 12, 13, ExclusionKind::kExcluded, "again"});
    const auto all = read_exclusions(file);
    ASSERT_EQ(all.size(), 2U);
    EXPECT_EQ(all[0].participant, 7U);
    EXPECT_EQ(all[0].position, 12U);
    EXPECT_EQ(all[0].record, 13U);
    EXPECT_EQ(all[0].kind, ExclusionKind::kRejected);
    EXPECT_EQ(all[0].reason, "hand slipped");
    ASSERT_NE(find_exclusion(all, 7, 13), nullptr);
    EXPECT_EQ(find_exclusion(all, 7, 13)->reason, "again");  // excluded wins
    EXPECT_EQ(find_exclusion(all, 7, 12), nullptr);
    EXPECT_EQ(find_exclusion(all, 8, 13), nullptr);
}

TEST(Exclusions, NoneWithoutAReason) {
    const TemporaryDirectory folder;
    EXPECT_THROW(add_exclusion(folder / "e.tsv", {7, 1, 1, ExclusionKind::kExcluded, " \t"}), Error);
    EXPECT_FALSE(std::filesystem::exists(folder / "e.tsv"));
}

TEST(Participants, ALineIsAddedAndNeverAltered) {
    const TemporaryDirectory folder;
    const Dataset dataset(folder.path());
    PersonDescription person{"31", "F", "left", "some", true};
    EXPECT_EQ(add_participant(dataset, 7, SubjectKind::kHuman, person), "");
    EXPECT_EQ(add_participant(dataset, 8, SubjectKind::kHuman, {.consent = true}), "");
    const std::string before = read_text(dataset.participants());
    EXPECT_EQ(before,
              "participant_id\tspecies\tage\tsex\thandedness\thaptic_experience\tsubject_kind\tconsent\n"
              "sub-07\thomo sapiens\t31\tF\tleft\tsome\thuman\tyes\n"
              "sub-08\thomo sapiens\tn/a\tn/a\tn/a\tn/a\thuman\tyes\n");
    EXPECT_EQ(add_participant(dataset, 7, SubjectKind::kHuman, person), "");
    EXPECT_EQ(add_participant(dataset, 7, SubjectKind::kHuman, {.consent = true}), "") << "nothing was said";
    EXPECT_EQ(add_participant(dataset, 7, SubjectKind::kHuman, {.sex = "F", .consent = true}), "");
    person.age = "32";
    EXPECT_THAT(add_participant(dataset, 7, SubjectKind::kHuman, person), HasSubstr("31, F"));
    EXPECT_EQ(read_text(dataset.participants()), before);
    add_participant(dataset, 1, SubjectKind::kVirtual, {"31", "F", "left", "some", true});
    EXPECT_EQ(read_text(dataset.participants()), before + "sub-01\tn/a\tn/a\tn/a\tn/a\tn/a\tvirtual\tn/a\n");
    EXPECT_EQ(read_participants(dataset), (std::vector<std::uint32_t>{7, 8, 1}));
}

TEST(Participants, AgesAsBidsWantsThem) {
    for (const auto& [said, text] :
         {std::pair{"31", "31"}, {"88", "88"}, {"89", "89+"}, {"104", "89+"}, {"89+", "89+"}, {"n/a", "n/a"}})
        EXPECT_EQ(age_text(said), text);
    for (const char* wrong : {"", "0", "121", "-3", "31.5", "old"})
        EXPECT_THAT(
            refusal([&] { age_text(wrong); }, ExitCode::kUsage),
            AllOf(HasSubstr(fmt::format("age {}: must be whole years", wrong)), Not(HasSubstr("--"))));
}

TEST(Corrections, IncludeSaysWhyAnIncludedTrialDoesNotCount) {
    const TemporaryDirectory folder;
    const Dataset dataset(folder / "d");
    dataset.open(SubjectKind::kVirtual, {});
    const auto order = plan_order(short_settings("attention_every = 3\n"), 2);
    RecordTable table(dataset.records(2));
    table.append(record_of(order[0], 1));
    table.append(record_of(order[1], 2, EndReason::kPeerLost));
    table.append(record_of(order[4], 3));
    for (const auto& included : {std::pair{1U, "but practice never counts"},
                                 {2U, "but it ended as peer_lost_visual and so does not count"},
                                 {5U, "but the statistics leave out attention trials"}}) {
        const auto include = [&] {
            include_trial(dataset.folder(), "P02", included.first, {"LS", "all", ""});
        };
        expect_refused(include, ExitCode::kUsage, included.second);
    }
}

}  // namespace
}  // namespace thimble
