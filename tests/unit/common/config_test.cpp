#include "common/config.hpp"

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/nearest_name.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

ConfigFile parse(std::string_view text) { return ConfigFile::parse(text, "trial.toml"); }

// The refusal's text. Fails the test if there is none or it is no usage error.
std::string refusal_of(const std::function<void()>& read) {
    try {
        read();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kUsage);
        return error.what();
    }
    ADD_FAILURE() << "was not refused";
    return "";
}

// A file whose third line is `line`, inside [net.link], read by `read`.
std::string refusal_of_line(const std::string& line, const std::function<void(const ConfigTable&)>& read) {
    const ConfigFile file = parse("# a comment\n[net.link]\n" + line + "\n");
    return refusal_of([&] { read(file.table("net").table("link")); });
}

TEST(Config, ReadsEveryType) {
    const ConfigFile file = parse(
        "[a]\nnumber = 1.5\nwhole = 2\ncount = -3\nyes = true\ntext = 'x'\ncolour = 'red'\nwait_s = 0.25\n"
        "list = [1, 2.5]\nnames = ['u', 'v']\n");
    const ConfigTable a = file.table("a");
    EXPECT_EQ(a.number("number", 0, 0, 2), 1.5);
    EXPECT_EQ(a.number("whole", 0, 0, 2), 2);  // a whole number is a number
    EXPECT_EQ(a.integer("count", 0, -5, 5), -3);
    EXPECT_TRUE(a.boolean("yes", false));
    EXPECT_EQ(a.text("text", ""), "x");
    EXPECT_EQ(a.choice("colour", 0, {"blue", "red"}), 1U);
    EXPECT_EQ(a.seconds("wait_s", {}, {}, seconds{1}), milliseconds{250});
    EXPECT_THAT(a.numbers("list", {}, 0, 3), ElementsAre(1, 2.5));
    EXPECT_THAT(a.texts("names", {}), ElementsAre("u", "v"));
    file.finish();
}

TEST(Config, MissingKeysAndTablesLeaveTheDefaults) {
    for (const ConfigFile& file : {parse(""), parse("[a]\n"), ConfigFile::empty()}) {
        const ConfigTable a = file.table("a");
        EXPECT_FALSE(a.has("number"));
        EXPECT_EQ(a.number("number", 7, 0, 1), 7);  // the default is the program's, not to be judged
        EXPECT_EQ(a.integer("count", 8, 0, 1), 8);
        EXPECT_TRUE(a.boolean("yes", true));
        EXPECT_EQ(a.text("text", "t"), "t");
        EXPECT_EQ(a.choice("colour", 1, {"blue", "red"}), 1U);
        EXPECT_EQ(a.seconds("wait_s", milliseconds{3}, {}, seconds{1}), milliseconds{3});
        EXPECT_THAT(a.numbers("list", {4}, 0, 1), ElementsAre(4));
        EXPECT_THAT(a.texts("names", {"n"}), ElementsAre("n"));
        EXPECT_EQ(a.table("inner").number("number", 9, 0, 1), 9);
        file.finish();
    }
}

TEST(Config, LimitsAreInside) {
    const ConfigFile file = parse("low = -1.0\nhigh = 1\nleast = -9223372036854775808\n");
    EXPECT_EQ(file.root().number("low", 0, -1, 1), -1);
    EXPECT_EQ(file.root().number("high", 0, -1, 1), 1);
    EXPECT_EQ(file.root().integer("least", 0, INT64_MIN, INT64_MAX), INT64_MIN);
}

TEST(Config, RefusesWithFileLineAndKey) {
    struct Case {
        const char* line;
        std::function<void(const ConfigTable&)> read;
        const char* why;
    };
    const std::vector<Case> cases{
        {"k = 'x'", [](const ConfigTable& t) { t.number("k", 0, 0, 1); }, "must be a number"},
        {"k = true", [](const ConfigTable& t) { t.number("k", 0, 0, 1); }, "must be a number"},
        {"k = [1]", [](const ConfigTable& t) { t.number("k", 0, 0, 1); }, "must be a number"},
        {"k = 1.1", [](const ConfigTable& t) { t.number("k", 0, 0, 1); }, "between 0 and 1"},
        {"k = -0.1", [](const ConfigTable& t) { t.number("k", 0, 0, 1); }, "between 0 and 1"},
        {"k = nan", [](const ConfigTable& t) { t.number("k", 0, 0, 1); }, "between 0 and 1"},
        {"k = inf", [](const ConfigTable& t) { t.number("k", 0, 0, 1e308); }, "must lie between"},
        {"k = 1.0", [](const ConfigTable& t) { t.integer("k", 0, 0, 1); }, "must be a whole number"},
        {"k = '1'", [](const ConfigTable& t) { t.integer("k", 0, 0, 1); }, "must be a whole number"},
        {"k = 2", [](const ConfigTable& t) { t.integer("k", 0, 0, 1); }, "between 0 and 1"},
        {"k = -1", [](const ConfigTable& t) { t.integer("k", 0, 0, 1); }, "between 0 and 1"},
        {"k = 1", [](const ConfigTable& t) { t.boolean("k", false); }, "must be true or false"},
        {"k = 'true'", [](const ConfigTable& t) { t.boolean("k", false); }, "must be true or false"},
        {"k = 1", [](const ConfigTable& t) { t.text("k", ""); }, "must be text in quotes"},
        {"k = 'pink'",
         [](const ConfigTable& t) {
             t.choice("k", 0, {"blue", "red"});
         },
         "one of blue, red"},
        {"k = 1",
         [](const ConfigTable& t) {
             t.choice("k", 0, {"blue", "red"});
         },
         "must be text"},
        {"k = 2.0", [](const ConfigTable& t) { t.seconds("k", {}, {}, seconds{1}); }, "between 0 and 1"},
        {"k = '1s'", [](const ConfigTable& t) { t.seconds("k", {}, {}, seconds{1}); }, "must be a number"},
        {"k = 1", [](const ConfigTable& t) { t.numbers("k", {}, 0, 1); }, "must be a list"},
        {"k = [0, 2]", [](const ConfigTable& t) { t.numbers("k", {}, 0, 1); }, "numbers between 0 and 1"},
        {"k = [nan]", [](const ConfigTable& t) { t.numbers("k", {}, 0, 1); }, "numbers between 0 and 1"},
        {"k = ['0']", [](const ConfigTable& t) { t.numbers("k", {}, 0, 1); }, "numbers between 0 and 1"},
        {"k = [true]", [](const ConfigTable& t) { t.numbers("k", {}, 0, 1); }, "numbers between 0 and 1"},
        {"k = 'a'", [](const ConfigTable& t) { t.texts("k", {}); }, "must be a list of texts"},
        {"k = ['a', 1]", [](const ConfigTable& t) { t.texts("k", {}); }, "must hold texts"},
        {"k = 1", [](const ConfigTable& t) { t.table("k"); }, "must be a table"},
        {"k = [{ a = 1 }]", [](const ConfigTable& t) { t.table("k"); }, "must be a table"},
        {"k = 1", [](const ConfigTable& t) { t.fail("k", "and l contradict"); }, "and l contradict"},
    };
    for (const Case& c : cases) {
        EXPECT_THAT(refusal_of_line(c.line, c.read),
                    AllOf(StartsWith("trial.toml:3:"), HasSubstr("'net.link.k'"), HasSubstr(c.why)))
            << c.line;
    }
}

TEST(Config, FailsWithoutALineForAKeyThatIsNotThere) {
    const ConfigFile file = parse("[a]\n");
    EXPECT_EQ(refusal_of([&] { file.table("a").fail("k", "is missing"); }), "trial.toml: 'a.k' is missing");
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
             Case{"[a]\nb = 1\n[a.inner]\nc = 2\nd = 3\n", "trial.toml:5:", "'a.inner.d'"},
             Case{"[a]\ninner.d = 3\n", "trial.toml:2:", "'a.inner.d'"},
             Case{"[a.inner.deeper]\n", "trial.toml:1:", "'a.inner.deeper'"},
         }) {
        const ConfigFile file = parse(c.text);
        file.table("a").number("b", 0, 0, 9);
        file.table("a").table("inner").number("c", 0, 0, 9);
        EXPECT_THAT(refusal_of([&] { file.finish(); }), AllOf(StartsWith(c.place), HasSubstr(c.key)))
            << c.text;
    }
}

// A dot inside quotes belongs to the key: "a.b" is not b of [a], so no reader has asked for it.
TEST(Config, AQuotedDotDoesNotPassForATable) {
    const ConfigFile file = parse("\"a.b\" = 3\n");
    EXPECT_EQ(file.table("a").number("b", 1, 0, 9), 1);
    EXPECT_THAT(refusal_of([&] { file.finish(); }), StartsWith("trial.toml:1:"));
}

TEST(Config, ATableOrAnArrayOfTables) {
    const ConfigFile one = parse("[layer]\nk = 1\n");
    ASSERT_EQ(one.root().tables("layer").size(), 1u);
    EXPECT_EQ(one.root().tables("layer")[0].number("k", 0, 0, 9), 1);
    one.finish();
    const ConfigFile two = parse("[[layer]]\nk = 1\n[[layer]]\nk = 2\n[[layer.event]]\nt = 3\n");
    const std::vector<ConfigTable> layers = two.root().tables("layer");
    ASSERT_EQ(layers.size(), 2u);
    EXPECT_EQ(layers[0].number("k", 0, 0, 9), 1);
    EXPECT_EQ(layers[1].number("k", 0, 0, 9), 2);
    ASSERT_EQ(layers[1].tables("event").size(), 1u);
    EXPECT_EQ(layers[1].tables("event")[0].number("t", 0, 0, 9), 3);
    EXPECT_TRUE(layers[0].tables("event").empty());
    two.finish();
    EXPECT_TRUE(parse("").root().tables("layer").empty());
}

TEST(Config, ArraysOfTablesAreCheckedKeyByKey) {
    const ConfigFile file = parse("[[layer]]\nk = 1\n[[layer]]\nk = 2\nK = 2\n");
    for (const ConfigTable& layer : file.root().tables("layer")) layer.number("k", 0, 0, 9);
    EXPECT_THAT(refusal_of([&] { file.finish(); }),
                AllOf(StartsWith("trial.toml:5:"), HasSubstr("'layer[1].K'")));
    EXPECT_THAT(refusal_of([] { parse("layer = 3\n").root().tables("layer"); }), HasSubstr("[[layer]]"));
    EXPECT_THAT(refusal_of([] { parse("layer = [1, 2]\n").root().tables("layer"); }), HasSubstr("[[layer]]"));
    // A quoted key with a bracket is no element of an array.
    EXPECT_THAT(refusal_of([] {
                    const ConfigFile quoted = parse("\"layer[0]\" = 1\n");
                    quoted.root().tables("layer");
                    quoted.finish();
                }),
                HasSubstr("layer[0]"));
}

TEST(Config, TablesOfOtherProgramsAreTheirs) {
    const ConfigFile file = parse("[mine]\nk = 1\n[theirs]\nwhatever = 1\n[theirs.inner]\nx = 'y'\n");
    file.table("mine").number("k", 0, 0, 1);
    file.finish({"theirs"});
    EXPECT_THAT(refusal_of([&] { file.finish({"mine"}); }), HasSubstr("'theirs'"));
}

TEST(Config, AskingForAKeyDoesNotAllowItsNeighbours) {
    const ConfigFile file = parse("[a]\nbb = 1\n");
    EXPECT_FALSE(file.table("a").has("b"));
    file.table("a").number("b", 0, 0, 1);
    EXPECT_THAT(refusal_of([&] { file.finish(); }), HasSubstr("'a.bb'"));
}

// has() asks, it does not read: a key that was only looked at is still unknown.
TEST(Config, LookingIsNotReading) {
    const ConfigFile file = parse("[a]\nb = 1\n");
    EXPECT_TRUE(file.table("a").has("b"));
    EXPECT_THAT(refusal_of([&] { file.finish(); }), HasSubstr("'a.b'"));
}

TEST(Config, RefusesWhatIsNotToml) {
    EXPECT_THAT(refusal_of([] { parse("a = 1\nb = = 2\n"); }),
                AllOf(StartsWith("trial.toml:2:"), HasSubstr("not TOML")));
    EXPECT_THAT(refusal_of([] { parse("a = 1\na = 2\n"); }), StartsWith("trial.toml:2:"));
    EXPECT_THAT(refusal_of([] { parse("a = '\xff\xfe'\n"); }), StartsWith("trial.toml:1:"));
}

class ConfigOnDisk : public testing::Test {
  protected:
    // The name holds the test's, since ctest runs tests side by side.
    ConfigOnDisk()
        : path_(std::filesystem::path(testing::TempDir()) /
                (std::string("thimble_") + testing::UnitTest::GetInstance()->current_test_info()->name() +
                 ".toml")) {}
    ~ConfigOnDisk() override { std::filesystem::remove(path_); }
    void write(const std::string& text) const { std::ofstream(path_, std::ios::binary) << text; }

    std::filesystem::path path_;
};

TEST_F(ConfigOnDisk, LoadsAndNamesTheFile) {
    write("[a]\nb = 2\n");
    const ConfigFile file = ConfigFile::load(path_);
    EXPECT_THAT(refusal_of([&] { file.table("a").number("b", 0, 0, 1); }),
                StartsWith(path_.string() + ":2:"));
}

TEST_F(ConfigOnDisk, AnEmptyFileIsAllDefaults) {
    write("");
    EXPECT_NO_THROW(ConfigFile::load(path_).finish());
}

TEST_F(ConfigOnDisk, RefusesWhatCannotBeRead) {
    EXPECT_THAT(refusal_of([&] { ConfigFile::load(path_); }),
                AllOf(StartsWith(path_.string()), HasSubstr("does it exist")));
    EXPECT_THAT(refusal_of([&] { ConfigFile::load(path_.parent_path()); }), HasSubstr("cannot read"));
}

TEST(Config, AMisspeltKeyIsToldWhichOneWasMeant) {
    const ConfigFile file = parse("[master]\nforce_limt_N = 3\nspeed = 1");
    const ConfigTable master = file.table("master");
    master.number("force_limit_N", 12, 0, 100);
    EXPECT_THAT(refusal_of([&] { file.finish(); }), AllOf(HasSubstr("unknown key 'master.force_limt_N'"),
                                                          HasSubstr("did you mean 'force_limit_N'?")));
}

TEST(Config, NotesWhatAReaderSaysOfItsKeys) {
    ConfigFile file = parse("");
    file.note_declarations();
    const ConfigTable link = file.table("link");
    link.number("delay_s", 0.05, 0, 60);
    link.choice("shape", 1, {"none", "normal"});
    const KeyDeclaration delay = file.declarations().at("link.delay_s");
    EXPECT_EQ(delay.type, "number");
    EXPECT_EQ(delay.fallback, "0.05");
    EXPECT_EQ(delay.range, "0 to 60");
    EXPECT_EQ(file.declarations().at("link.shape").fallback, "\"normal\"");
    EXPECT_THAT(file.declarations().at("link.shape").choices, ElementsAre("none", "normal"));
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
