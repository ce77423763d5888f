// Tables that grow by a plan: gone on with, refused, replaced.
#include "study/planned_table.hpp"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/text_file.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

TEST(PlannedTable, GoesOnBehindTheWholeRowsOfTheSamePlan) {
    const TemporaryDirectory directory;
    const std::filesystem::path path = directory / "map";
    const auto open = [&path](const std::string& plan, IfExists if_exists) {
        return PlannedTable(path, "map", "map", plan, "head\n", if_exists);
    };
    {
        PlannedTable table = open("plan", IfExists::kRefuse);
        table.append("a\nb\n");
        table.append("c\n");
        EXPECT_EQ(table.done(), 3U);
        EXPECT_EQ(read_text(path / "map.csv"), "head\na\nb\nc\n");
        std::ofstream(path / "map.csv", std::ios::app) << "half a row";
        EXPECT_THROW(open("plan", IfExists::kContinue), Error);  // it is still written
        EXPECT_EQ(read_text(path / "map.csv"), "head\na\nb\nc\nhalf a row");
    }
    EXPECT_THROW(open("plan", IfExists::kRefuse), Error);
    EXPECT_EQ(open("plan", IfExists::kContinue).done(), 3U);
    EXPECT_THROW(open("another", IfExists::kContinue), Error);
    EXPECT_EQ(open("another", IfExists::kReplace).done(), 0U);
    EXPECT_EQ(read_text(path / "map.csv"), "head\n");
}

// As one that is killed between table and plan: a table beside another plan would be refused, or gone on with.
TEST(PlannedTable, WithoutItsPlanThereIsNoTable) {
    const TemporaryDirectory directory;
    const std::filesystem::path table = directory / "map.csv", plan = directory / "map.txt";
    std::ofstream(table) << "head\na\n";
    std::filesystem::create_directory(plan);
    EXPECT_THROW(open_plan(table, plan, "map", "plan", IfExists::kReplace), Error);
    EXPECT_FALSE(std::filesystem::exists(table));
    std::filesystem::remove(plan);
    open_plan(table, plan, "map", "plan", IfExists::kContinue);
    EXPECT_EQ(read_text(table), "");
    EXPECT_EQ(read_text(plan), "plan");
}

TEST(PlannedTable, AMissingPlanIsNamed) {
    const TemporaryDirectory directory;
    EXPECT_THAT(refusal([&] { require_plan(directory / "trials.txt", "study", "plan"); }, ExitCode::kUsage),
                testing::HasSubstr((directory / "trials.txt").string() + ": is missing"));
}

// Its trials would be others, so --resume and ranks refuse it.
TEST(SessionText, AnotherSceneOfTheSameNameIsAnotherPlan) {
    const TemporaryDirectory directory;
    const std::filesystem::path session = directory / "session.toml", scene = directory / "scene.toml";
    std::ofstream(session) << "[slave_sim]\nscene = 'scene.toml'\n";
    const auto text = [&](const std::string& damping) {
        std::ofstream(scene) << "[tissue]\ndamping_Ns_per_m = " << damping << "\n[fixture]\n";
        return session_text(load_system_settings(session));
    };
    const std::string before = text("3");
    EXPECT_EQ(before, "scene.toml sha256 " + sha256_of_file(scene) +
                          "\nsession file:\n[slave_sim]\nscene = 'scene.toml'\n");
    EXPECT_EQ(text("3"), before);
    EXPECT_NE(text("4"), before);
    EXPECT_EQ(session_text(load_system_settings({})), "session file:\n");
}

}  // namespace
}  // namespace thimble
