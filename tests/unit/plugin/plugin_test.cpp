// Loading plug-ins: what is refused, with which words. Table [control] with a plug-in.
#include <array>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "common/control/built_in_controllers.hpp"
#include "common/control/controller_ends.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/plugin/plugins.hpp"

namespace thimble::test {
namespace {

using testing::HasSubstr;

std::string refused(const std::filesystem::path& file) {
    return refusal([&] { load_plugin(file); }, ExitCode::kUsage);
}

TEST(Plugin, TheExampleIsLoadedWithItsKeys) {
    const PluginSettings plugin = load_plugin(plugin_file("mine"));
    EXPECT_STREQ(plugin.table->name, "mine");
    EXPECT_THAT(plugin.values, testing::ElementsAre(0.002, 3));
    EXPECT_EQ(plugin_hand_share(plugin), 1);
}

TEST(Plugin, AFileThatIsNoneIsNamed) {
    const TemporaryDirectory folder;
    write_text(folder / "text.so", "no library");
    EXPECT_THAT(refused(folder / "absent.so"), HasSubstr("absent.so: there is no such file"));
    EXPECT_THAT(refused(folder / "text.so"), HasSubstr("text.so"));
    EXPECT_THAT(refused(folder.path()), HasSubstr("no such file"));
    EXPECT_THAT(refused(plugin_file("no_symbol")), HasSubstr("does not export thimble_controller_table()"));
    EXPECT_THAT(refused(plugin_file("bad_abi")), HasSubstr("version 99"));
}

ControlSettings read(const TemporaryDirectory& folder, const std::string& control) {
    write_text(folder / "session.toml", "[control]\n" + control);
    const ConfigFile file = ConfigFile::load(folder / "session.toml");
    ControlSettings settings;
    file.read_all([&] { settings = read_control_settings(file); });
    return settings;
}

TEST(Plugin, ASessionNamesItBesideItsFile) {
    const TemporaryDirectory folder;
    std::filesystem::copy(plugin_file("mine"), folder / "mine.so");
    const ControlSettings settings =
        read(folder, "plugin = 'mine.so'\n[control.plugin_settings]\ndamping_Ns_per_m = 7\n");
    EXPECT_EQ(settings.compensator, Compensator::kPlugin);
    EXPECT_THAT(settings.plugin.values, testing::ElementsAre(0.002, 7));
    const auto refused_by = [&](const std::string& text) {
        return refusal([&] { read(folder, text); }, ExitCode::kUsage);
    };
    EXPECT_THAT(refused_by("plugin = 'mine.so'\n[control.plugin_settings]\ndamping = 7\n"),
                HasSubstr("damping"));
    EXPECT_THAT(refused_by("plugin = 'mine.so'\n[control.plugin_settings]\ntrust_s = 11\n"),
                HasSubstr("trust_s"));
    EXPECT_THAT(refused_by("plugin = 'mine.so'\ncompensator = 'wave'\n"), HasSubstr("remove one of them"));
    EXPECT_THAT(refused_by("plugin = 'yours.so'\n"), HasSubstr("no such file"));
    EXPECT_THAT(refused_by("[control.plugin_settings]\ntrust_s = 1\n"), HasSubstr("trust_s"));
    EXPECT_THAT(refused_by("compensator = 'plugin'\n"), HasSubstr("compensator"));
}

TEST(Plugin, OneThatRefusesItsSettingsIsAnErrorOfTheSession) {
    EXPECT_THAT(refusal([] { HandleEnd(bad(Fault::kRefuse), {}); }, ExitCode::kUsage), HasSubstr("create()"));
}

TEST(Plugin, ATableThatBreaksARuleIsRefused) {
    const thimble_controller good = wave_controller();
    ASSERT_EQ(wrong_table(good), "");
    using Change = void (*)(thimble_controller&);
    const std::array<Change, 14> changes{[](thimble_controller& t) { t.abi = 0; },
                                         [](thimble_controller& t) { t.name = nullptr; },
                                         [](thimble_controller& t) { t.name = ""; },
                                         [](thimble_controller& t) { t.capabilities |= 1U << 31; },
                                         [](thimble_controller& t) { t.capabilities |= THIMBLE_AT_ONCE; },
                                         [](thimble_controller& t) { t.keys = nullptr; },
                                         [](thimble_controller& t) { t.key_count = 1'000'000'000; },
                                         [](thimble_controller& t) { t.create = nullptr; },
                                         [](thimble_controller& t) { t.destroy = nullptr; },
                                         [](thimble_controller& t) { t.start = nullptr; },
                                         [](thimble_controller& t) { t.sample = nullptr; },
                                         [](thimble_controller& t) { t.force = nullptr; },
                                         [](thimble_controller& t) { t.create_slave = nullptr; },
                                         [](thimble_controller& t) { t.step_slave = nullptr; }};
    for (std::size_t i = 0; i < changes.size(); ++i) {
        thimble_controller table = good;
        changes.at(i)(table);
        EXPECT_NE(wrong_table(table), "") << i;
    }
}

TEST(Plugin, AKeyWithoutAnOrderedRangeIsRefused) {
    EXPECT_TRUE(rc::check("the range decides", [](double fallback, double low, double high) {
        const bool none = *rc::gen::element(false, false, true);
        if (none) high = std::numeric_limits<double>::quiet_NaN();
        const thimble_controller_key key{"gain", fallback, low, high, "Of the force."};
        thimble_controller table = passivity_controller();
        table.keys = &key;
        RC_ASSERT(wrong_table(table).empty() == (low <= fallback && fallback <= high));
    }));
    const std::array twice{thimble_controller_key{"gain", 0, 0, 1, ""},
                           thimble_controller_key{"gain", 0, 0, 1, ""}};
    thimble_controller table = passivity_controller();
    table.keys = twice.data();
    table.key_count = 2;
    EXPECT_THAT(wrong_table(table), HasSubstr("twice"));
}

TEST(Plugin, AForceThatIsNoNumberIsNone) {
    HandleEnd end(bad(Fault::kNotANumber), {});
    end.start({});
    thimble_feedback pushes{};
    pushes.force_total_hand_N = 3;
    pushes.known = 1;
    for (int i = 0; i < 30; ++i) {
        end.sample(SessionTime{std::chrono::milliseconds{i}}, 0, 0, 0);
        end.receive(pushes);
        EXPECT_EQ(end.force_N(), i < 20 ? 3 : 0) << i;
    }
    EXPECT_EQ(end.tally().not_numbers, 10U);
}

SessionTime slow_clock() {
    static SessionTime now{};
    return now += std::chrono::microseconds{600};
}

// Two readings for each call: sample() and force() take 1.2 ms of a sample's 1 ms.
TEST(Plugin, CallsThatTakeLongerThanASamplePeriodAreCounted) {
    ControlSettings settings = control_of("mine");
    settings.clock = slow_clock;
    HandleEnd end(settings, {});
    end.start({});
    for (int i = 0; i < 5; ++i) {
        end.sample(SessionTime{std::chrono::milliseconds{i}}, 0, 0, 0);
        end.force_N();
    }
    EXPECT_EQ(end.tally().late_samples, 4U) << "the last one is not over";
    EXPECT_EQ(end.tally().longest_call, std::chrono::microseconds{600});
}

}  // namespace
}  // namespace thimble::test
