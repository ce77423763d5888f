// One folder holds virtual or human data, never both, and nothing else.
#include "session/participant/dataset.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/version.hpp"
#include "session/participant/record_table.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

void expect_refused(const std::function<void()>& what, ExitCode code, const std::string& words) {
    EXPECT_THAT(refusal(what, code), testing::HasSubstr(words));
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
    for (const std::string_view column : record_columns()) {
        EXPECT_TRUE(json.contains(column)) << column;
    }
    EXPECT_EQ(json.size(), record_columns().size() + 2);  // TaskName and TaskDescription, nothing stale
}

}  // namespace
}  // namespace thimble
