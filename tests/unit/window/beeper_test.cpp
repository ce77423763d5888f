#include "visual_node/window/beeper.hpp"

#include <algorithm>
#include <cstdlib>

#include <gtest/gtest.h>

namespace thimble {
namespace {

int loudest(const std::vector<std::int16_t>& samples) {
    int most = 0;
    for (const std::int16_t sample : samples) most = std::max(most, std::abs(static_cast<int>(sample)));
    return most;
}

// OpenAL dithers silence by one step: less than a hundred is none.
int rises(const std::vector<std::int16_t>& samples) {
    int found = 0;
    bool low = false;
    for (const std::int16_t sample : samples) {
        if (low && sample > 100) ++found;
        low = sample < -100 || (low && sample <= 100);
    }
    return found;
}

TEST(Beep, IsAToneOfItsFrequencyWithoutClicks) {
    const auto samples = samples_of({}, 44100);
    EXPECT_EQ(samples.size(), 8820U);  // 0.2 s
    EXPECT_NEAR(rises(samples), 176, 1);
    EXPECT_NEAR(loudest(samples), 16384, 100);
    EXPECT_EQ(samples.front(), 0);
    EXPECT_LT(std::abs(static_cast<int>(samples.back())), 300);
}

TEST(Beep, IsHeardOnceEachTime) {
    Beeper beeper(Tone{}, Beeper::Loopback{});
    if (!beeper.can_sound()) GTEST_SKIP() << "OpenAL without ALC_SOFT_loopback: " << beeper.notice();
    std::vector<std::int16_t> before(4410), during(8820), after(8820);
    beeper.render(before);
    EXPECT_LE(loudest(before), 2);
    beeper.beep();
    beeper.render(during);
    EXPECT_GT(loudest(during), 3000);
    EXPECT_NEAR(rises(during), 176, 4);
    std::vector<std::int16_t> rest(4410);
    beeper.render(rest);  // what the mixer still had
    beeper.render(after);
    EXPECT_LE(loudest(after), 2);
    beeper.beep();
    beeper.render(during);
    EXPECT_GT(loudest(during), 3000);
}

TEST(Beep, SaysWhyItIsSilent) {
    setenv("ALSOFT_DRIVERS", "nonesuch", 1);
    Beeper beeper;
    unsetenv("ALSOFT_DRIVERS");
    if (beeper.can_sound()) GTEST_SKIP() << "OpenAL has read its settings already";
    EXPECT_EQ(beeper.notice().substr(0, 8), "no sound");
    beeper.beep();  // harmless
}

}  // namespace
}  // namespace thimble
