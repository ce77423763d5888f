// Files as people write them: what is read, what is refused and with which words, and what readers say of their keys.
#include "common/config.hpp"

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/nearest_name.hpp"
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
    for (const Case& c : std::vector<Case>{{"number", "'x'", "must be a number, not a string"},
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
                                           {"wait_s", "'1s'", "must be a number"},
                                           {"list", "1", "must be a list, [1, 2]"},
                                           {"list", "[0, 4]", "must hold numbers between 0 and 3"},
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
    EXPECT_EQ(refusal_of([&] { file.table("a").fail("l", "is missing"); }), "trial.toml: 'a.l' is missing");
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

TEST(Config, LoadsAndNamesTheFile) {
    // The name holds the test's, since ctest runs tests side by side.
    const auto path = std::filesystem::path(testing::TempDir()) / "thimble_LoadsAndNamesTheFile.toml";
    EXPECT_THAT(refusal_of([&] { ConfigFile::load(path); }),
                AllOf(StartsWith(path.string()), HasSubstr("does it exist")));
    EXPECT_THAT(refusal_of([&] { ConfigFile::load(path.parent_path()); }), HasSubstr("cannot read"));
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

TEST(NearestName, FindsSwappedLettersAndAnotherCaseButNoOtherWord) {
    EXPECT_EQ(nearest_name("dealy_s", {"delay_s", "loss"}), "delay_s");
    EXPECT_EQ(nearest_name("hf", {"CF", "HF"}), "HF");
    EXPECT_EQ(nearest_name("speed", {"delay_s", "loss"}), "");
    EXPECT_EQ(nearest_name("", {"a"}), "a");
    EXPECT_EQ(nearest_name("x", {}), "");
}

}  // namespace
}  // namespace thimble
