// Good needle and scene files, damaged as editors, spreadsheets and attackers do: what is still read must be as
// promised. The seeded little sister of fuzz_needle, fuzz_scene and fuzz_recorded, for every build and every compiler.
#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "common/random.hpp"
#include "tests/fuzz/needle_check.hpp"
#include "tests/fuzz/recorded_check.hpp"
#include "tests/fuzz/scene_check.hpp"

namespace thimble {
namespace {

constexpr std::array kNumbers{"0",     "1",    "-1",   "-0.0",   "0.02",  "1e-15",
                              "1e-12", "1e-9", "1e-6", "1e-3",   "1e3",   "1e6",
                              "1e9",   "1e12", "1e13", "5e-324", "1e300", "1e999",
                              "nan",   "-inf", "+0.5", "",       "0x1",   "0.0200000000000000003"};

std::uint32_t below(std::size_t n, RandomStream& random) {
    return random.below(static_cast<std::uint32_t>(n));
}

std::vector<std::string> files_in(const std::string& folder) {
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(THIMBLE_SOURCE_DIR "/" + folder)) {
        paths.push_back(entry.path());
    }
    std::sort(paths.begin(), paths.end());  // a folder has no order of its own
    std::vector<std::string> texts;
    for (const auto& path : paths) {
        std::ifstream in(path, std::ios::binary);
        texts.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    }
    return texts;
}

bool in_number(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.'; }

// What stands after an = or a comma, mostly: that is where numbers are.
void set_number(std::string& text, RandomStream& random) {
    const std::size_t from = below(text.size(), random);
    const auto first = std::find_if(text.begin() + static_cast<std::ptrdiff_t>(from), text.end(), in_number);
    const auto last = std::find_if_not(first, text.end(), in_number);
    text.replace(first, last, kNumbers[below(kNumbers.size(), random)]);
}

void set_byte(std::string& text, RandomStream& random) {
    using namespace std::literals;
    constexpr std::string_view kBytes = "\0\n\r\t ,#=[]\"'.-+e9z\xef\xff"sv;
    text[below(text.size(), random)] = kBytes[below(kBytes.size(), random)];
}

std::string line_at(const std::string& text, std::size_t at, std::size_t& first) {
    first = text.rfind('\n', at) + 1;  // npos + 1 is the beginning
    if (text[at] == '\n') first = at;
    return text.substr(first, text.find('\n', at) - first) + '\n';
}

void remove_line(std::string& text, RandomStream& random) {
    std::size_t first = 0;
    const std::string line = line_at(text, below(text.size(), random), first);
    text.erase(first, line.size());
}

void repeat_line(std::string& text, RandomStream& random) {
    std::size_t first = 0;
    const std::string line = line_at(text, below(text.size(), random), first);
    text.insert(first, line);
}

void cut(std::string& text, RandomStream& random) { text.resize(below(text.size(), random)); }

void join(std::string& text, const std::vector<std::string>& seeds, RandomStream& random) {
    text += seeds[below(seeds.size(), random)];
}

// One to three wounds, mostly to numbers: a file that is damaged too much is refused at the first look.
std::string damaged(const std::vector<std::string>& seeds, RandomStream& random) {
    std::string text = seeds[below(seeds.size(), random)];
    for (std::uint32_t n = 1 + random.below(3); n > 0; --n) {
        if (text.empty()) return text;
        const std::uint32_t wound = random.below(16);
        if (wound == 0) cut(text, random);
        if (wound == 1) join(text, seeds, random);
        if (wound == 2) remove_line(text, random);
        if (wound == 3) repeat_line(text, random);
        if (wound == 4 || wound == 5) set_byte(text, random);
        if (wound > 5) set_number(text, random);
    }
    return text;
}

template <class Check>
void expect_no_flaw(const std::string& folder, int cases, const Check& check) {
    const std::vector<std::string> seeds = files_in(folder);
    ASSERT_GE(seeds.size(), 5u);
    RandomStream random(StreamKey{.study = 22, .purpose = Purpose::kLinkLoss});
    int accepted = 0;
    for (int i = 0; i < cases; ++i) {
        const std::string text = damaged(seeds, random);
        const Verdict verdict = check(text);
        ASSERT_EQ(verdict.flaw, "") << "case " << i << ":\n" << text;
        accepted += verdict.accepted ? 1 : 0;
    }
    // The cases are worth something only if they come to both ends.
    EXPECT_GT(accepted, cases / 10);
    EXPECT_LT(accepted, cases * 9 / 10);
}

template <class Check>
void expect_all_read(const std::string& folder, const Check& check) {
    for (const std::string& text : files_in(folder)) {
        const Verdict verdict = check(text);
        EXPECT_TRUE(verdict.accepted) << text;
        EXPECT_EQ(verdict.flaw, "") << text;
    }
}

TEST(HostileFiles, SeedsAreRead) {
    expect_all_read("tests/fuzz/seeds_needle", check_needle_file);
    expect_all_read("deploy/scenes", check_scene_file);
    expect_all_read("tests/fuzz/seeds_recorded", check_recorded_file);
}

TEST(HostileFiles, NeedleFilesAreRefusedOrGood) {
    expect_no_flaw("tests/fuzz/seeds_needle", 20'000, check_needle_file);
}

TEST(HostileFiles, RecordedTrialsAreRefusedOrTheSameAgain) {
    expect_no_flaw("tests/fuzz/seeds_recorded", 2'000, check_recorded_file);
}

TEST(HostileFiles, ScenesAreRefusedOrStayFinite) {
    expect_no_flaw("deploy/scenes", 10'000, check_scene_file);
}

}  // namespace
}  // namespace thimble
