// Tables that grow by a plan: gone on with, refused, replaced.
#include "study/planned_table.hpp"

#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "common/error.hpp"
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
    }
    EXPECT_EQ(read_text(path / "map.csv"), "head\na\nb\nc\n");
    std::ofstream(path / "map.csv", std::ios::app) << "half a row";
    EXPECT_THROW(open("plan", IfExists::kRefuse), Error);
    EXPECT_EQ(open("plan", IfExists::kContinue).done(), 3U);
    EXPECT_THROW(open("another", IfExists::kContinue), Error);
    EXPECT_EQ(open("another", IfExists::kReplace).done(), 0U);
    EXPECT_EQ(read_text(path / "map.csv"), "head\n");
}

}  // namespace
}  // namespace thimble
