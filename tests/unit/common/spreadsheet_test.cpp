// Tables that went through a spreadsheet: what is taken, and how the rest is named.

#include <array>
#include <fstream>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/csv/csv.hpp"
#include "common/error.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(Spreadsheet, LeavesAPlainTableAsItIs) {
    for (const std::string_view text :
         {"", "a,b\n1,2\n", "a,b\n1,2", "# a;b\na,b\n1;2,3\n", "a\tb;c\n1\t2,5\n", "a;b,c\n1,5;2\n"})
        EXPECT_EQ(plain_table(std::string(text), "x", text.starts_with("a\t") ? '\t' : ','), text);
}

TEST(Spreadsheet, MarksAndLineEndsGo) {
    EXPECT_EQ(plain_table("\xEF\xBB\xBF"
                          "a,b\r\n1,2\r\n3,4\r",
                          "x"),
              "a,b\n1,2\n3,4");
    EXPECT_EQ(plain_table("a\rb,c\n", "x"), "a\rb,c\n");
}

TEST(Spreadsheet, SemicolonsAndDecimalCommasAreRead) {
    EXPECT_EQ(plain_table("# x;1,5\na;b;c\n1,5;-2;x\n;+0,25e-3;\n", "x"),
              "# x;1,5\na,b,c\n1.5,-2,x\n,+0.25e-3,\n");
    EXPECT_EQ(plain_table("a;b\n1.5;2\n", "x"), "a,b\n1.5,2\n");
    EXPECT_EQ(plain_table("a;b\n1,5;2\n", "x", '\t'), "a\tb\n1.5\t2\n");
}

TEST(Spreadsheet, NamesWhatItCannotRead) {
    const auto said = [](const std::string& text, Semicolons semicolons = Semicolons::kTake) {
        return refusal([&] { plain_table(text, "t.csv", ',', semicolons); }, ExitCode::kData);
    };
    EXPECT_THAT(said("a;b\n1;1.234,5\n"), AllOf(StartsWith("t.csv:2:"), HasSubstr("'1.234,5'")));
    EXPECT_THAT(said("a;b\n1;one, two\n"),
                AllOf(StartsWith("t.csv:2:"), HasSubstr("not as a decimal comma")));
    EXPECT_THAT(said("a;b\n1;1,234,567\n"), StartsWith("t.csv:2:"));
    EXPECT_THAT(said("a;b\n1,5;2\n3;2.5\n"),
                AllOf(StartsWith("t.csv:3:"), HasSubstr("line 2 has a decimal comma")));
    EXPECT_THAT(said("\xFF\xFE"
                     "a"),
                HasSubstr("UTF-16"));
    EXPECT_THAT(said("a;b\n", Semicolons::kRefuse), HasSubstr("save it with commas"));
}

// By the reader of the project's own tables.
class SpreadsheetTable : public testing::Test {
  protected:
    std::filesystem::path write(const std::string& text) const {
        const auto path = folder_ / "t.csv";
        std::ofstream(path, std::ios::binary) << text;
        return path;
    }
    static constexpr std::array<std::string_view, 2> kNames{"delay_s", "name"};
    TemporaryDirectory folder_;
};

TEST_F(SpreadsheetTable, IsReadAsWritten) {
    CsvReader reader(write("\xEF\xBB\xBF"
                           "delay_s;name\r\n0,05;HF\r\n"),
                     kNames);
    ASSERT_TRUE(reader.next());
    EXPECT_EQ(reader.field(0).number(), 0.05);
    EXPECT_EQ(reader.field(1).text, "HF");
    EXPECT_FALSE(reader.next());
}

TEST_F(SpreadsheetTable, IsNotContinuedWithSemicolons) {
    const auto begin = [&](const char* text) {
        CsvReader(write(text), kNames, ',', 0, LastLine::kMayBeTorn);
    };
    EXPECT_NO_THROW(
        begin("\xEF\xBB\xBF"
              "delay_s,name\r\n0.05,HF\r\n"));
    EXPECT_THAT(refusal([&] { begin("delay_s;name\n0,05;HF\n"); }), HasSubstr("lines are to be added"));
}

TEST_F(SpreadsheetTable, AFolderIsNoTable) {
    EXPECT_THAT(refusal([&] { CsvReader(folder_.path(), kNames); }, ExitCode::kData),
                HasSubstr("is a folder"));
}

}  // namespace
}  // namespace thimble
