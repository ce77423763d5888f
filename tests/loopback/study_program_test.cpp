// `thimble study` and `thimble analyse` as users start them.
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/process/child.hpp"
#include "tests/loopback/programs.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using Json = nlohmann::ordered_json;

bool has_gnuplot() {
    try {
        run_program("gnuplot", {"-V"}, ".", "");
    } catch (const Error&) {
        return false;
    }
    return true;
}

// Each also as PDF.
void expect_figures(const std::filesystem::path& out) {
    for (const char* figure : {"trajectories", "bars", "subjects", "distributions", "differences"}) {
        EXPECT_THAT(read_text(out / "figures" / (std::string(figure) + ".pdf")), StartsWith("%PDF"));
        EXPECT_THAT(read_text(out / "figures" / (std::string(figure) + ".svg")), HasSubstr("</svg>"));
    }
    EXPECT_THAT(read_text(out / "report.html"), Not(HasSubstr("o figures:")));
}

TEST(StudyProgram, RemovalsAreRunKeptResumedAndAnalysed) {
    const bool draws = has_gnuplot();
    const Folder folder;
    const std::string out = (folder / "out").string();
    const std::vector<std::string> command{"study", "--experiment", "2", "--subjects", "4", "--out", out};
    const Outcome study = run_thimble(command);
    EXPECT_EQ(study.code, 0) << study.words;
    EXPECT_THAT(study.words, HasSubstr("peak displacement"));
    EXPECT_THAT(read_text(folder / "out" / "subjects.csv"), StartsWith("cohort,subject,"));
    const std::string table = read_text(folder / "out" / "trials.csv");
    if (draws) expect_figures(folder / "out");

    EXPECT_EQ(run_thimble(command).code, 2);  // refuses to overwrite
    std::vector<std::string> resume = command;
    resume.emplace_back("--resume");
    const Outcome again = run_thimble(resume);
    EXPECT_EQ(again.code, 0) << again.words;
    EXPECT_THAT(again.words, HasSubstr("8 trials were already done"));
    EXPECT_EQ(read_text(folder / "out" / "trials.csv"), table);
    std::filesystem::remove(folder / "out" / "trials_curves.csv");
    const Outcome without_curves = run_thimble(resume);
    EXPECT_EQ(without_curves.code, 5) << without_curves.words;
    EXPECT_THAT(without_curves.words, AllOf(HasSubstr("trials_curves.csv"), HasSubstr("--out")));
    resume.insert(resume.end(), {"--seed", "2"});
    EXPECT_EQ(run_thimble(resume).code, 2);
    EXPECT_EQ(read_text(folder / "out" / "trials.csv"), table);

    const Outcome analysed = run_thimble({"analyse", out, "--out", (folder / "analysis").string()});
    EXPECT_EQ(analysed.code, 0) << analysed.words;
    EXPECT_THAT(analysed.words,
                AllOf(HasSubstr("Which conditions oscillate"), HasSubstr("peak displacement")));
    for (const char* file : {"findings.json", "claims.json"})
        EXPECT_EQ(read_text(folder / "analysis" / file), read_text(folder / "out" / file)) << file;
    for (const char* file : {"trials.csv", "summary.json", "claims.json", "report.html"}) {
        const std::string before = read_text(folder / "out" / file);
        EXPECT_EQ(run_thimble({"analyse", out, "--out", out + '/' + file}).code, 2) << file;
        EXPECT_EQ(read_text(folder / "out" / file), before) << file;
    }
    EXPECT_EQ(run_thimble({"report", "--study", out, "--out", out + "/trials.csv"}).code, 2);
    EXPECT_EQ(read_text(folder / "out" / "trials.csv"), table);

    const Outcome printed = run_thimble({"analyse", out, "--json"});
    EXPECT_EQ(printed.code, 0) << printed.words;
    const auto parsed = Json::parse(printed.words);
    EXPECT_EQ(parsed["claims"].dump(), Json::parse(read_text(folder / "out" / "claims.json")).dump());
    EXPECT_EQ(parsed["findings"].dump(), Json::parse(read_text(folder / "out" / "findings.json")).dump());
    EXPECT_EQ(parsed["answer"].size(), 3U);
    if (!draws) GTEST_SKIP() << "gnuplot is not installed (package gnuplot-nox)";
}

// Of a table by itself its rows say whether the design is the paper's; beside a summary the summary does.
TEST(StudyProgram, ClaimsAreJudgedOnlyOfThePapersDesign) {
    const Folder folder;
    const std::string out = (folder / "out").string();
    const Outcome study = run_thimble({"study", "--experiment", "3", "--subjects", "1", "--out", out});
    EXPECT_EQ(study.code, 0) << study.words;
    EXPECT_THAT(study.words, HasSubstr("1 subject is too few for a test between modalities"));
    const auto claims_of = [&](const std::filesystem::path& table) {
        const Outcome analysed = run_thimble({"analyse", table.string(), "--json"});
        EXPECT_EQ(analysed.code, 0) << analysed.words;
        return Json::parse(analysed.words).value("claims", Json::array()).size();
    };
    EXPECT_GT(claims_of(out), 20U);
    const Folder elsewhere;
    const std::filesystem::path table = elsewhere / "trials.csv";
    std::filesystem::copy_file(folder / "out" / "trials.csv", table);
    EXPECT_GT(claims_of(table), 20U);
    // Tables beside its trials are not what a study's claims are about.
    const std::filesystem::path side = folder / "out" / "hf_wave.csv";
    std::filesystem::copy_file(table, side);
    EXPECT_EQ(claims_of(side), 0U);
    const std::string claims = read_text(folder / "out" / "claims.json"),
                      results = (elsewhere / "a").string();
    EXPECT_EQ(run_thimble({"analyse", side.string(), "--out", out}).code, 2);
    EXPECT_EQ(read_text(folder / "out" / "claims.json"), claims);
    EXPECT_EQ(run_thimble({"analyse", table.string(), "--out", results}).code, 0);
    EXPECT_TRUE(std::filesystem::exists(elsewhere / "a/claims.json"));
    EXPECT_EQ(run_thimble({"analyse", side.string(), "--out", results}).code, 0);
    EXPECT_FALSE(std::filesystem::exists(elsewhere / "a/claims.json"));
    std::ofstream(elsewhere / "summary.json") << R"({"provenance": {"design": "user"}})";
    EXPECT_EQ(claims_of(table), 0U);
    std::filesystem::remove(elsewhere / "summary.json");
    std::string rows = read_text(table);
    for (std::size_t at = rows.find(",0.05,"); at != std::string::npos; at = rows.find(",0.05,", at))
        rows.replace(at, 6, ",0.02,");
    std::ofstream(table) << rows;
    EXPECT_EQ(claims_of(table), 0U);
}

// The fit and the options say what ran, not the session file. Commands that share an option's variable once shared its default too:
// results went into "out/report.html".
TEST(StudyProgram, AllParametersAreThoseThatRanAndNoNamedFolderMeansItsOwn) {
    const Folder folder;
    const std::string fit = (folder / "fit.json").string();
    std::ofstream(fit) << R"({"parameters": {"operator.criterion_N": {"median": 3.25}}})";
    const std::filesystem::path before = std::filesystem::current_path(), out = folder / "here/out/study";
    std::filesystem::create_directory(folder / "here");
    std::filesystem::current_path(folder / "here");
    const Outcome study = run_thimble({"study", "--experiment", "3", "--subjects", "1", "--seed", "9",
                                       "--order", "williams", "--no-control", "--from", fit});
    std::filesystem::current_path(before);
    EXPECT_EQ(study.code, 0) << study.words;
    EXPECT_TRUE(std::filesystem::exists(out / "trials.csv"));
    const Json provenance = Json::parse(read_text(out / "summary.json"))["provenance"];
    EXPECT_THAT(provenance["all parameters of paper-experiment-3.toml"].get<std::string>(),
                AllOf(HasSubstr("\noperator.criterion_N = 3.25\n"),
                      HasSubstr("\noperator.spread_speed = 0\n"), HasSubstr("\nsession.seed = 9\n"),
                      HasSubstr("\nsession.order = \"williams\"\n"), HasSubstr("\nprotocol.subjects = 1\n")));
    EXPECT_THAT(provenance["fit " + fit].get<std::string>(), HasSubstr("3.25"));
    // Another person's trials are not its.
    std::ofstream(fit) << R"({"parameters": {"operator.criterion_N": {"median": 3.5}}})";
    const Outcome other =
        run_thimble({"study", "--experiment", "3", "--subjects", "1", "--seed", "9", "--order", "williams",
                     "--no-control", "--from", fit, "--out", out.string(), "--resume"});
    EXPECT_EQ(other.code, 2);
    EXPECT_THAT(other.words, HasSubstr("other settings"));
}

TEST(StudyProgram, MistakesAreNamed) {
    const Folder folder;
    EXPECT_EQ(run_thimble({"study", "--experiment", "4"}).code, 2);
    EXPECT_EQ(run_thimble({"study", "--order", "latin"}).code, 2);
    EXPECT_EQ(run_thimble({"study", "--resume", "--overwrite"}).code, 2);
    EXPECT_EQ(run_thimble({"study", "--seeds", "2", "--json"}).code, 2);
    const std::string out = (folder / "out").string();
    for (const std::vector<std::string>& sweep : {std::vector<std::string>{"--seeds", "2"},
                                                  {"--draws", "2"},
                                                  {"--vary", "handle.friction_N=0.5:1:2"}}) {
        for (const char* option : {"--resume", "--trajectories", "--json", "--no-control"}) {
            std::vector<std::string> command{"study", option, "--out", out};
            command.insert(command.end(), sweep.begin(), sweep.end());
            const Outcome refused = run_thimble(command);
            EXPECT_EQ(refused.code, 2) << refused.words;
            EXPECT_THAT(refused.words, HasSubstr(sweep[0]));
            EXPECT_FALSE(std::filesystem::exists(out));
        }
    }
    for (const char* range : {"handle.fricion_N=0:1:3", "handle.friction_N=0:1", "handle.friction_N=0:9:3"}) {
        const std::string varied = (folder / "varied").string();
        const Outcome refused = run_thimble({"study", "--vary", range, "--out", varied});
        EXPECT_EQ(refused.code, 2) << refused.words;
        EXPECT_THAT(refused.words, HasSubstr("handle.fric"));
        EXPECT_FALSE(std::filesystem::exists(varied));
    }
    const Outcome missing = run_thimble({"analyse", (folder / "nothing.csv").string()});
    EXPECT_EQ(missing.code, 5) << missing.words;
    EXPECT_THAT(missing.words, HasSubstr("nothing.csv"));
}

}  // namespace
}  // namespace thimble
