// The board that comes with the program: what it compares, and the sessions of its rows.
#include "study/board/board_plan.hpp"

#include <array>
#include <fstream>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "study/board/board_row.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

SystemSettings settings_of(const std::string& session) {
    return read_system_settings(ConfigFile::parse(session, "row"));
}

BoardPlan board_of(const std::vector<std::string>& only) {
    BoardPlan plan = read_board(board_folder());
    keep_only(plan, only);
    return plan;
}

TEST(BoardPlan, TwelveControllersInFortyTwoConditionsAllReadable) {
    const BoardPlan plan = read_board(board_folder());
    EXPECT_GE(plan.version, 1U);
    EXPECT_GE(plan.controllers.size(), 12U);
    ASSERT_EQ(plan.conditions.size(), 42U);
    std::set<std::string> names;
    for (const BoardCondition& condition : plan.conditions) names.insert(condition.name);
    EXPECT_EQ(names.size(), 42U);
    EXPECT_TRUE(names.count("200ms+jitter+loss") == 1 && names.count("wifi+passive") == 1);
    // Each controller over one condition, and each condition of one controller.
    const std::size_t own = plan.codecs.size() * plan.conditions.size();
    for (std::size_t c = 0; c < plan.controllers.size(); ++c)
        EXPECT_NO_THROW(settings_of(row_session(plan, place_of(plan, c * own + c)))) << c;
    for (std::size_t i = 0; i < plan.conditions.size(); ++i)
        EXPECT_NO_THROW(settings_of(row_session(plan, place_of(plan, i)))) << plan.conditions[i].name;
}

TEST(BoardPlan, ARowsSessionHasItsThreeFragments) {
    const BoardPlan plan = board_of({"scaled", "every-sample", "50ms+jitter+loss"});
    ASSERT_EQ(plan.rows(), 1U);
    const SystemSettings settings = settings_of(row_session(plan, place_of(plan, 0), 4));
    EXPECT_EQ(settings.plan.subject, 4U);
    EXPECT_EQ(settings.plan.delays, std::vector<Duration>{std::chrono::milliseconds(50)});
    EXPECT_EQ(settings.master.control.compensator, Compensator::kScaled);
    EXPECT_GT(settings.master.control.share, 0.01);
    EXPECT_LT(settings.master.control.share, 0.05);  // what the loop bears at 50 ms and the jitter
    EXPECT_EQ(settings.netem.force.jitter.spread, std::chrono::milliseconds(5));
}

TEST(BoardPlan, LaterFragmentsReplaceKeysOfEarlierOnes) {
    const std::array<std::string, 2> fragments{"a.x = 1\na.y = 2\n", "[a]\ny = 3\n[b]\nz = 4\n"};
    const std::array<std::string, 1> whole{"[a]\nx = 1\ny = 3\n[b]\nz = 4\n"};
    EXPECT_EQ(joined_fragments(fragments, "test"), joined_fragments(whole, "test"));
}

TEST(BoardPlan, AnUnknownNameIsRefusedWithThoseThatThereAre) {
    const std::vector<std::string> names{"HF", "waves"};
    EXPECT_THAT(refusal([&] { board_of(names); }, ExitCode::kUsage),
                AllOf(HasSubstr("--only waves"), HasSubstr("wave")));
}

// It costs its own row, which says why.
TEST(BoardRows, AContestantThatCannotRunIsARowWithItsReason) {
    BoardPlan plan = board_of({"HF", "every-sample", "0ms"});
    plan.trials = 1;
    plan.controllers.push_back({"broken", "", "control.compensator = \"no, such\"\n"});
    EXPECT_EQ(run_board_row(plan, 0).status, "ok");
    const BoardRow row = run_board_row(plan, 1);
    EXPECT_EQ(row.trials, 0U);
    EXPECT_TRUE(row.possible()) << "a mistake in an entry is a failure";
    EXPECT_THAT(row.status, HasSubstr("control.compensator"));
    EXPECT_EQ(row.status.find_first_of(",\n\""), std::string::npos);
}

TEST(BoardRows, WaveVariablesWithACodecAreNotPossible) {
    const BoardPlan plan = board_of({"wave", "deadband", "0ms"});
    EXPECT_FALSE(run_board_row(plan, 0).possible());
}

// Another file under the same name is another board.
TEST(BoardPlan, APluginStandsForItsContentAndHasANameOfItsOwn) {
    const TemporaryDirectory folder;
    BoardPlan plan = board_of({"HF"});
    std::ofstream(folder / "mine.so") << "one";
    add_plugin(plan, folder / "mine.so");
    const std::string before = plan_text(plan);
    std::ofstream(folder / "mine.so") << "two";
    EXPECT_NE(plan_text(plan), before);
    const auto add = [&](const char* name) {
        std::ofstream(folder / name) << "x";
        add_plugin(plan, folder / name);
    };
    for (const char* name : {"mine.py", "HF.so", "a,b.so", "a b.so"})  // the first two names are there
        EXPECT_NE(refusal([&] { add(name); }, ExitCode::kUsage), "nothing was refused") << name;
    EXPECT_NO_THROW(add("a-b_c.2.so"));
}

// No file of the plug-in is opened where its session is only written.
TEST(BoardPlan, ASessionOfAPluginIsWrittenWithoutLoadingIt) {
    const TemporaryDirectory folder;
    BoardPlan plan = board_of({"HF", "every-sample", "0ms"});
    std::ofstream(folder / "mine.so") << "no library";
    add_plugin(plan, folder / "mine.so");
    EXPECT_THAT(row_session(plan, place_of(plan, 1)), HasSubstr("mine.so"));
}

}  // namespace
}  // namespace thimble
