// Before `thimble play` opens a window.
#include "session/play/play_starter.hpp"

#include <filesystem>
#include <unistd.h>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/refusal.hpp"

namespace thimble {
namespace {

// Another user may have put a link there.
TEST(PlayStarter, LooksForAWindowWithoutAFileOfAKnownName) {
    namespace fs = std::filesystem;
    const TemporaryDirectory folder;
    const fs::path link = fs::temp_directory_path() / fmt::format("thimble_help_{}", ::getpid());
    fs::create_symlink(folder / "mine", link);
    write_text(folder / "thimble-visual", "#!/bin/sh\necho --help\n");
    fs::permissions(folder / "thimble-visual", fs::perms::owner_all);
    EXPECT_THAT(refusal([&] { check_window(folder.path()); }, ExitCode::kUsage),
                testing::HasSubstr("without a window"));
    EXPECT_FALSE(fs::exists(folder / "mine"));
    fs::remove(link);
}

}  // namespace
}  // namespace thimble
