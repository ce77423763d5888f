// Table [codec] of a session file.
#include "common/reduction/codec_settings.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"

namespace thimble {
namespace {

CodecSettings read_codec(const std::string& keys) {
    const ConfigFile file = ConfigFile::parse("[codec]\n" + keys, "session.toml");
    CodecSettings settings;
    file.read_all([&] {
        settings = read_codec_settings(file.table("codec"));
        check_refresh(file.table("codec"), settings, "visual", std::chrono::milliseconds(100));
    });
    return settings;
}

std::string codec_refusal(const std::string& keys) {
    try {
        read_codec(keys);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(CodecSettings, SendEverythingByDefault) {
    EXPECT_FALSE(read_codec("").used());
    EXPECT_TRUE(read_codec("force = 'every-nth'\nevery = 5").used());
}

TEST(CodecSettings, RefuseAKeyWithoutEffect) {
    EXPECT_THAT(codec_refusal("command = 'every-nth'\nweber_fraction = 0.2"),
                testing::HasSubstr("weber_fraction"));
    EXPECT_THAT(codec_refusal("refresh_s = 0.02"), testing::HasSubstr("has no effect"));
    EXPECT_THAT(codec_refusal("force = 'deadband'\ndelta_position_m = 0.001"),
                testing::HasSubstr("delta_position_m"));
}

TEST(CodecSettings, RefuseARefreshBoundThatTwoLostPacketsWouldBreak) {
    EXPECT_EQ(codec_refusal("force = 'deadband'\nrefresh_s = 0.033"), "");
    EXPECT_THAT(codec_refusal("force = 'deadband'\nrefresh_s = 0.034"),
                testing::HasSubstr("visual.stale_after_s"));
}

}  // namespace
}  // namespace thimble
