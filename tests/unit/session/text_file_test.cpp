#include "common/text_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

// Long enough to leave any buffer before the file is closed, and short enough to stay in it.
const std::string kTexts[] = {std::string(100'000, 'x'), "a line\n"};

void expect_refused(const std::filesystem::path& path) {
    for (const std::string& text : kTexts)
        EXPECT_THAT(refusal([&] { write_text_file(path, text); }, ExitCode::kRunFailed),
                    testing::HasSubstr(path.string()));
}

TEST(TextFile, IsReplacedAndKeepsEveryByte) {
    const TemporaryDirectory directory;
    const std::string first("a\r\n\0b\xff", 6);
    write_text_file(directory / "text", first);
    EXPECT_EQ(read_text(directory / "text"), first);
    write_text_file(directory / "text", "c");
    EXPECT_EQ(read_text(directory / "text"), "c");
    write_text_file(directory / "text", "");
    EXPECT_TRUE(std::filesystem::is_empty(directory / "text"));
}

TEST(TextFile, MissingDirectoryIsNamed) {
    const TemporaryDirectory directory;
    expect_refused(directory / "nowhere" / "text");
    EXPECT_FALSE(std::filesystem::exists(directory / "nowhere"));
}

TEST(TextFile, FullDiskIsAnError) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
    expect_refused("/dev/full");
}

TEST(Folder, IsMadeWithThoseOnTheWay) {
    const TemporaryDirectory directory;
    for (int twice = 0; twice < 2; ++twice) make_folder(directory / "a/b");
    EXPECT_TRUE(std::filesystem::is_directory(directory / "a/b"));
    make_folder("");
}

TEST(Folder, ThatCannotBeMadeIsNamed) {
    const TemporaryDirectory directory;
    write_text_file(directory / "file", "");
    for (const std::filesystem::path& folder : {directory / "file", directory / "file/in it"})
        EXPECT_THAT(refusal([&] { make_folder(folder); }, ExitCode::kUsage),
                    testing::HasSubstr(folder.string()));
}

}  // namespace
}  // namespace thimble
