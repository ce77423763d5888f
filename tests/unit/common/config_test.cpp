// Files as people write them: what is read, what is refused and with which words, and what readers say of their keys.
#include "common/config.hpp"

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

enum class Colour : std::uint8_t { kBlue, kRed };

// One key of each type, at its default.
struct Everything {
    double number = 7;
    std::optional<double> maybe{};
    std::int64_t count = 8;
    bool yes = true;
    std::string text = "t";
    Colour colour = Colour::kRed;
    Duration wait = milliseconds{3};
    std::vector<double> list{4};
    std::vector<std::string> names{"n"};
    bool operator==(const Everything&) const = default;
};

Everything read_everything(const ConfigTable& table) {
    Everything e;
    table.read("number", e.number, 0, 2, "A number.");
    table.read("maybe", e.maybe, 0, 2, "Or none.");
    table.read("count", e.count, -5, 5, "Whole.");
    table.read("yes", e.yes, "Or no.");
    table.read("text", e.text, "Words.");
    table.read("colour", e.colour, {"blue", "red"}, "One of two.");
    table.read("wait_s", e.wait, 0, 1, "Time.");
    table.read("list", e.list, 0, 3, "Numbers.");
    table.read("names", e.names, "Texts.");
    return e;
}

ConfigFile parse(std::string_view text) { return ConfigFile::parse(text, "trial.toml"); }

void read_number(const ConfigTable& table, std::string_view key) {
    double any = 0;
    table.read(key, any, 0, 9, "");
}

void no_keys(const ConfigTable& /*table*/) {}

template <class Read>
std::string refusal_of(const Read& read) {
    return refusal(read, ExitCode::kUsage);
}

TEST(Config, ReadsEveryType) {
    const ConfigFile file = parse(
        "[a]\nnumber = 2\nmaybe = 1.5\ncount = -3\nyes = false\ntext = 'x'\ncolour = 'blue'\nwait_s = 0.25\n"
        "list = [1, 2.5]\nnames = ['u', 'v']\n");
    // A whole number is a number, and limits are inside.
    EXPECT_EQ(read_everything(file.table("a")),
              (Everything{2, 1.5, -3, false, "x", Colour::kBlue, milliseconds{250}, {1, 2.5}, {"u", "v"}}));
    file.finish();
    std::int64_t least = 0;
    parse("k = -9223372036854775808").root().read("k", least, INT64_MIN, INT64_MAX, "");
    EXPECT_EQ(least, INT64_MIN);
}

TEST(Config, MissingKeysAndTablesLeaveTheDefaults) {
    for (const ConfigFile& file : {parse(""), parse("[a]\n"), ConfigFile::empty()}) {
        EXPECT_FALSE(file.table("a").has("number"));
        // The default is the program's, not to be judged.
        EXPECT_EQ(read_everything(file.table("a")), Everything{});
        read_number(file.table("a").table("inner"), "number");
        file.finish();
    }
}

TEST(Config, RefusesWithFileLineAndKey) {
    struct Case {
        const char *key, *value, *why;
    };
    for (const Case& c : std::vector<Case>{
             {"number", "'x'", "must be a number, not a string"},
             {"number", "true", "must be a number"},
             {"number", "[1]", "must be a number"},
             {"number", "2.1", "is 2.1, but must lie between 0 and 2"},
             {"number", "-0.1", "between 0 and 2"},
             {"number", "nan", "between 0 and 2"},
             {"number", "inf", "between 0 and 2"},
             {"maybe", "3", "between 0 and 2"},
             {"count", "1.0", "must be a whole number, not a float"},
             {"count", "'1'", "must be a whole number"},
             {"count", "6", "is 6, but must lie between -5 and 5"},
             {"count", "-6", "between -5 and 5"},
             {"yes", "1", "must be true or false"},
             {"yes", "'true'", "must be true or false"},
             {"text", "1", "must be text in quotes"},
             {"colour", "'pink'", "is \"pink\", but must be one of blue, red"},
             {"colour", "1", "must be text in quotes"},
             {"wait_s", "2.0", "between 0 and 1"},
             {"wait_s", "'1xs'", "is \"1xs\": write seconds as a number, or a number with a unit"},
             {"wait_s", "'0.5'", "a number with a unit (ns, us, ms, s, min, h)"},
             {"wait_s", "'2 s'", "is 2, but must lie between 0 and 1"},
             {"wait_s", "20", "between 0 and 1; for 20 ms write 0.02 or \"20ms\""},
             {"number", "'1s'", "must be a number, not a string"},
             {"list", "1", "must be a list, [1, 2]"},
             {"list", "[0, 4.1, 1, 'x']", "holds 4.1, 'x', but must hold numbers between 0 and 3"},
             {"list", "[nan]", "numbers between 0 and 3"},
             {"list", "['0']", "numbers between 0 and 3"},
             {"list", "[true]", "numbers between 0 and 3"},
             {"names", "'a'", "must be a list of texts"},
             {"names", "['a', 1]", "must hold texts"}}) {
        SCOPED_TRACE(std::string(c.key) + " = " + c.value);
        const ConfigFile file = parse(std::string("# a comment\n[a.b]\n") + c.key + " = " + c.value);
        EXPECT_THAT(refusal_of([&] { read_everything(file.table("a").table("b")); }),
                    AllOf(StartsWith("trial.toml:3:"), HasSubstr(std::string("'a.b.") + c.key + "' "),
                          HasSubstr(c.why)));
    }
    for (const char* text : {"k = 1", "k = [{ a = 1 }]"}) {
        EXPECT_THAT(refusal_of([&] { parse(text).table("k"); }), HasSubstr("must be a table, [k]"));
    }
}

TEST(Config, FailsWithALineForAKeyThatIsThere) {
    const ConfigFile file = parse("[a]\nk = 1\n");
    EXPECT_EQ(refusal_of([&] { file.table("a").fail("k", "is odd"); }), "trial.toml:2:5: 'a.k' is odd");
    EXPECT_EQ(refusal_of([&] { file.table("a").fail("l", "is missing"); }),
              "trial.toml:1:1: 'a.l' is missing");
}

TEST(Config, RefusesUnknownKeysAndTablesWithTheirPlace) {
    struct Case {
        const char *text, *place, *key;
    };
    for (const Case& c : {
             Case{"\nextra = 1\n", "trial.toml:2:", "'extra'"},
             Case{"[other]\n", "trial.toml:1:", "'other'"},
             Case{"[[other]]\n", "trial.toml:1:", "'other'"},
             Case{"[a]\nb = 1\nB = 1\n", "trial.toml:3:", "'a.B'"},
             Case{"[a]\nbb = 1\n", "trial.toml:2:", "'a.bb'"},
             Case{"[a]\nb = 1\n[a.inner]\nc = 2\nd = 3\n", "trial.toml:5:", "'a.inner.d'"},
             Case{"[a]\ninner.d = 3\n", "trial.toml:2:", "'a.inner.d'"},
             Case{"[a.inner.deeper]\n", "trial.toml:1:", "'a.inner.deeper'"},
             // A dot inside quotes belongs to the key.
             Case{"\"a.b\" = 3\n", "trial.toml:1:", "'a.b'"},
             Case{"[[layer]]\nk = 1\n[[layer]]\nk = 2\nK = 2\n", "trial.toml:5:", "'layer[1].K'"},
             // A quoted key with a bracket is no element of an array.
             Case{"\"layer[0]\" = 1\n", "trial.toml:1:", "'layer[0]'"},
             Case{"[looked_at]\n", "trial.toml:1:", "'looked_at'"},
         }) {
        const ConfigFile file = parse(c.text);
        read_number(file.table("a"), "b");
        read_number(file.table("a").table("inner"), "c");
        for (const ConfigTable& layer : file.root().tables("layer", no_keys)) read_number(layer, "k");
        file.root().has("looked_at");  // asks, and does not read
        EXPECT_THAT(refusal_of([&] { file.finish(); }), AllOf(StartsWith(c.place), HasSubstr(c.key)))
            << c.text;
    }
}

TEST(Config, ATableOrAnArrayOfTables) {
    const ConfigFile one = parse("[layer]\nk = 1\n");
    EXPECT_EQ(one.root().tables("layer", no_keys).size(), 1u);
    const ConfigFile two = parse("[[layer]]\nk = 1\n[[layer]]\nk = 2\n[[layer.event]]\nt = 3\n");
    const std::vector<ConfigTable> layers = two.root().tables("layer", no_keys);
    ASSERT_EQ(layers.size(), 2u);
    for (std::int64_t i = 0; i < 2; ++i) {
        std::int64_t k = 0;
        layers[static_cast<std::size_t>(i)].read("k", k, 0, 9, "");
        EXPECT_EQ(k, i + 1);
    }
    ASSERT_EQ(layers[1].tables("event", no_keys).size(), 1u);
    read_number(layers[1].tables("event", no_keys)[0], "t");
    EXPECT_TRUE(layers[0].tables("event", no_keys).empty());
    two.finish();
    EXPECT_TRUE(parse("").root().tables("layer", no_keys).empty());
    for (const char* text : {"layer = 3", "layer = [1, 2]"}) {
        EXPECT_THAT(refusal_of([&] { parse(text).root().tables("layer", no_keys); }), HasSubstr("[[layer]]"));
    }
}

TEST(Config, ANumberOrATable) {
    double loss = 0.5;
    EXPECT_FALSE(parse("").root().number_or_table("loss", loss, 0, 1, ""));
    EXPECT_EQ(loss, 0.5);
    EXPECT_FALSE(parse("loss = 0.1").root().number_or_table("loss", loss, 0, 1, ""));
    EXPECT_EQ(loss, 0.1);
    EXPECT_TRUE(parse("[loss]").root().number_or_table("loss", loss, 0, 1, ""));
    EXPECT_THAT(refusal_of([&] { parse("loss = 'x'").root().number_or_table("loss", loss, 0, 1, ""); }),
                HasSubstr("must be a number"));
}

TEST(Config, AKeyOfAnotherChoiceIsRefused) {
    const ConfigFile file = parse("[a]\nspeed = 1\n");
    read_number(file.table("a").only_with("mode", "fast", {"fast", "slow"}), "speed");
    read_number(file.table("a").only_with("mode", "off", {"fast", "slow"}), "absent");
    EXPECT_EQ(
        refusal_of([&] {
            read_number(file.table("a").only_with("mode", "off", {"fast", "slow"}), "speed");
        }),
        "trial.toml:2:9: 'a.speed' has no effect with mode = \"off\": remove it, or choose fast or slow");
}

TEST(Config, TablesOfOtherProgramsAreTheirs) {
    const ConfigFile file = parse("[mine]\nk = 1\n[theirs]\nwhatever = 1\n[theirs.inner]\nx = 'y'\n");
    read_number(file.table("mine"), "k");
    file.finish({"theirs"});
    EXPECT_THAT(refusal_of([&] { file.finish({"mine"}); }), HasSubstr("'theirs'"));
}

TEST(Config, RefusesWhatIsNotToml) {
    EXPECT_THAT(refusal_of([] { parse("a = 1\nb = = 2\n"); }),
                AllOf(StartsWith("trial.toml:2:"), HasSubstr("not TOML")));
    EXPECT_THAT(refusal_of([] { parse("a = 1\na = 2\n"); }), StartsWith("trial.toml:2:"));
    EXPECT_THAT(refusal_of([] { parse("a = '\xff\xfe'\n"); }), StartsWith("trial.toml:1:"));
}

// Each dot between names is a table in a table. The library destroys them one within the other: 50,000 overflowed the stack.
TEST(Config, RefusesAKeyOfVeryManyNamesAndNoListOfNumbers) {
    std::string names = "a", numbers = "0.5";
    for (int i = 0; i < 50'000; ++i) names += ".1", numbers += ", 0.5";
    for (const std::string& text :
         {"[" + names + "]", "[" + names + "]\n=", names + " = 1", "[[" + names + "]]"})
        EXPECT_THAT(refusal_of([&] { parse(text); }), HasSubstr("trial.toml:1:")) << text.substr(0, 5);
    EXPECT_EQ(refusal_of(
                  [&] { parse("list = [" + numbers + "] # ....................................... 1.2.3"); }),
              "nothing was refused");
}

TEST(Config, RefusesAFileThatDoesNotEnd) {
    EXPECT_THAT(refusal_of([] { ConfigFile::load("/dev/zero"); }),
                HasSubstr("/dev/zero: has more than 1048576 bytes"));
}

TEST(Config, AnErrorQuotesNoCommandsToTheTerminal) {
    EXPECT_EQ(refusal_of([] { parse("\"\\u001b[2J\\u009b2J\\u007f\\u00e9\" = 1").finish(); }),
              "trial.toml:1:35: unknown table or key '?[2J?2J?\u00e9': check the spelling, or remove it");
}

TEST(Config, SecondsMayHaveAUnit) {
    const ConfigFile file =
        parse("a_s = '20 ms'\nb_s = ['9ms', 0.05, '2s']\nc_s = '100us'\ndelay_s = '5s'\n");
    Duration a{};
    std::vector<double> b;
    double c = 0, delay_s = 0;
    file.root().read("a_s", a, 0, 1, "");
    file.root().read("b_s", b, 0, 3, "");
    file.root().read("c_s", c, 0, 1, "");
    file.root().read("delay_s", delay_s, 0, 60, "");
    EXPECT_EQ(a, milliseconds{20});
    EXPECT_THAT(b, ElementsAre(0.009, 0.05, 2));
    EXPECT_EQ(c, 1e-4);
    EXPECT_EQ(delay_s, 5) << "said with its unit, it is meant";
    EXPECT_THAT(refusal_of([&] { parse("delay_s = 5").root().read("delay_s", delay_s, 0, 60, ""); }),
                HasSubstr("'delay_s' holds 5, but no network takes 5 s: for 5 ms write 0.005"));
}

// Reads on after each: what is wrong, and what depends on it.
TEST(Config, AllMistakesOfAFileAreSaidAtOnceInItsOrder) {
    const ConfigFile file = parse(
        "[c]\nunknown = 1\n[a]\nnumber = 'x'\ncount = 9\ncolour = 'pink'\nwait_s = '1xs'\nyes = false\n"
        "[[layer]]\nk = 1\n[[layer]]\nk = 'x'\nnumbr = 1\n[b]\nnumber = 3\nlist = [9]\ntext = 't'\n");
    Everything b;
    int reads = 0;
    const std::string text = refusal_of([&] {
        file.read_all([&] {
            ++reads;
            const Everything a = read_everything(file.table("a"));
            if (a.number > 2 && !a.yes) file.table("a").fail("yes", "must be true for a number above 2");
            for (const ConfigTable& layer : file.root().tables("layer", no_keys)) read_number(layer, "k");
            b = read_everything(file.table("b"));
            if (b.yes && file.table("b").has("text")) file.table("b").fail("absent", "is needed with text");
        });
    });
    EXPECT_THAT(text, StartsWith("trial.toml has 10 errors:\ntrial.toml:1:1: unknown table or key 'c'"));
    std::string::size_type at = 0;
    for (const char* line :
         {"\ntrial.toml:4:10: 'a.number' must be a number", "\ntrial.toml:5:9: 'a.count' is 9",
          "\ntrial.toml:6:10: 'a.colour' is \"pink\"", "\ntrial.toml:7:10: 'a.wait_s' is",
          "\ntrial.toml:12:5: 'layer[1].k' must be", "\ntrial.toml:13:9: unknown key 'layer[1].numbr'",
          "\ntrial.toml:14:1: 'b.absent' is needed", "\ntrial.toml:15:10: 'b.number' is 3",
          "\ntrial.toml:16:8: 'b.list' holds 9, but must hold"}) {
        EXPECT_NE(text.find(line, at), std::string::npos) << line << " in " << text;
        at = text.find(line);
    }
    EXPECT_EQ(text.find("must be true"), std::string::npos) << "follows from the wrong number";
    EXPECT_GT(reads, 7);
}

TEST(Config, OneMistakeIsALineOfItsOwnAndManyAreCounted) {
    const ConfigFile one = parse("[a]\nnumber = 3\n");
    EXPECT_EQ(refusal_of([&] { one.read_all([&] { read_everything(one.table("a")); }); }),
              "trial.toml:2:10: 'a.number' is 3, but must lie between 0 and 2");
    std::string text = "[a]\n";
    for (int i = 0; i < 70; ++i) text += fmt::format("x{} = 1\n", i);
    const ConfigFile many = parse(text);
    EXPECT_THAT(refusal_of([&] { many.read_all([&] { read_everything(many.table("a")); }); }),
                AllOf(StartsWith("trial.toml has 70 errors:"), HasSubstr("... and 20 more")));
}

TEST(Config, WhatIsWrongWithANamedFileIsAMistakeOfItsKey) {
    const ConfigFile file = parse("[a]\nscene = 'vein.toml'\nnumber = 3\n");
    const std::string text = refusal_of([&] {
        file.read_all([&] {
            std::string scene;
            file.table("a").read("scene", scene, "");
            if (!scene.empty())
                file.table("a").load("scene", [&] { ConfigFile::parse("x = 1", scene).finish(); });
            read_everything(file.table("a"));
        });
    });
    EXPECT_THAT(text, AllOf(StartsWith("trial.toml has 2 errors:\ntrial.toml:2:9: vein.toml:1:5: unknown"),
                            HasSubstr("trial.toml:3:10: 'a.number'")))
        << text;
}

TEST(Config, LoadsAndNamesTheFile) {
    // The name holds the test's, since ctest runs tests side by side.
    const auto path = std::filesystem::path(testing::TempDir()) / "thimble_LoadsAndNamesTheFile.toml";
    EXPECT_THAT(refusal_of([&] { ConfigFile::load(path); }),
                AllOf(StartsWith(path.string()), HasSubstr("does it exist")));
    EXPECT_THAT(refusal_of([&] { ConfigFile::load(path.parent_path()); }), HasSubstr("is a folder"));
    std::ofstream(path) << "";
    EXPECT_NO_THROW(ConfigFile::load(path).finish());
    std::ofstream(path) << "[a]\nb = 20\n";
    const ConfigFile file = ConfigFile::load(path);
    EXPECT_THAT(refusal_of([&] { read_number(file.table("a"), "b"); }), StartsWith(path.string() + ":2:"));
    std::filesystem::remove(path);
}

TEST(Config, AMisspeltKeyIsToldWhichOneWasMeant) {
    const ConfigFile file = parse("[master]\nforce_limt_N = 3\nspeed = 1");
    read_number(file.table("master"), "force_limit_N");
    EXPECT_THAT(refusal_of([&] { file.finish(); }), AllOf(HasSubstr("unknown key 'master.force_limt_N'"),
                                                          HasSubstr("did you mean 'force_limit_N'?")));
}

TEST(Config, AKeyWithoutItsUnitOrInAnotherTableIsNamedWithItsTable) {
    const auto advice = [](const std::string& text) {
        const ConfigFile file = parse(text);
        read_number(file.table("fixture"), "stiffness_N_per_m");
        read_number(file.table("tissue"), "stiffness_N_per_m");
        read_number(file.table("trial"), "timeout_s");
        read_number(file.table("session"), "delays_s");
        read_number(file.table("netem").table("force"), "delay_s");
        return refusal_of([&] { file.finish(); });
    };
    EXPECT_THAT(advice("[fixture]\nstiffness = 1"), HasSubstr("did you mean 'stiffness_N_per_m'? Otherwise"));
    EXPECT_THAT(advice("[netem.force]\ndelay_ms = 50"), HasSubstr("did you mean 'delay_s'? Otherwise"));
    EXPECT_THAT(advice("[session]\nstiffness = 1"),
                HasSubstr("'stiffness_N_per_m' in [fixture] or [tissue]?"));
    EXPECT_THAT(advice("[session]\ntimeout_s = 1"), HasSubstr("did you mean 'timeout_s' in [trial]?"));
    EXPECT_THAT(advice("[session]\ndelay_s = 1"),
                HasSubstr("did you mean 'delays_s', or 'delay_s' in [netem.force]?"));
    EXPECT_THAT(advice("timeout_s = 1"), HasSubstr("did you mean 'timeout_s' in [trial]?"));
}

TEST(Config, ADescriptionHasWhatReadersSayOfTheirKeys) {
    const ConfigFile file = ConfigFile::description();
    read_everything(file.table("a").only_with("mode", "off", {"fast", "slow"}));
    double loss = 0;
    EXPECT_TRUE(file.root().number_or_table("loss", loss, 0, 1, "Share."));
    EXPECT_TRUE(file.root().tables("layer", read_everything).empty());
    std::string colour;
    file.table("a").read("colour", colour, "");  // another reader, which leaves the words to the first
    std::map<std::string, KeyDeclaration> keys;
    for (const KeyDeclaration& key : file.declarations()) EXPECT_TRUE(keys.emplace(key.path, key).second);
    EXPECT_EQ(file.declarations()[1].path, "a.number") << "in the order of reading, after [a] itself";
    const KeyDeclaration& wait = keys.at("a.wait_s");
    EXPECT_THAT(wait.types, ElementsAre("number"));
    EXPECT_EQ(wait.fallback, "0.003");
    EXPECT_EQ(wait.low + " to " + wait.high, "0 to 1");
    EXPECT_EQ(wait.help, "fast, slow: Time.");
    EXPECT_THAT(keys.at("loss").types, ElementsAre("number", "table"));
    EXPECT_THAT(keys.at("layer").types, ElementsAre("tables"));
    EXPECT_EQ(keys.at("layer[].maybe").fallback, "");
    EXPECT_EQ(keys.at("layer[].names").fallback, "[\"n\"]");
    EXPECT_EQ(keys.at("a.colour").fallback, "\"red\"");
    EXPECT_THAT(keys.at("a.colour").choices, ElementsAre("blue", "red"));
    EXPECT_EQ(keys.at("a.colour").help, "fast, slow: One of two.");
}

}  // namespace
}  // namespace thimble
