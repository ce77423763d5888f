// Good descriptions of networks, damaged: what is still read must be as promised. The seeded little sister of
// fuzz_network_files, for every build and every compiler.
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "common/random.hpp"
#include "tests/fuzz/network_check.hpp"

namespace thimble {
namespace {

constexpr int kCases = 20'000;
constexpr std::array<std::string_view, 16> kPieces{"0",    "1",           "-1", "1e-9", "1e999", "nan",
                                                   "100%", "99999999999", "\n", ",",    " ",     "loss",
                                                   "0.5",  "1ms",         "\"", "="};

std::uint32_t below(std::size_t n, RandomStream& random) {
    return random.below(static_cast<std::uint32_t>(n));
}

std::vector<std::string> seeds() {
    std::set<std::filesystem::path> paths;  // a folder has no order of its own
    for (const auto& entry :
         std::filesystem::directory_iterator(THIMBLE_SOURCE_DIR "/tests/fuzz/seeds_network")) {
        paths.insert(entry.path());
    }
    std::vector<std::string> texts;
    for (const auto& path : paths) {
        std::ifstream in(path, std::ios::binary);
        texts.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    }
    return texts;
}

// One to three wounds behind the first byte, small ones most often.
std::string damaged(std::string text, RandomStream& random) {
    for (std::uint32_t n = 1 + random.below(3); n > 0 && text.size() > 2; --n) {
        const std::size_t at = 1 + below(text.size() - 1, random);
        switch (random.below(8)) {
            case 0:
                text.resize(at);
                break;
            case 1:
                text.erase(at, 1 + random.below(8));
                break;
            case 2:
                text.insert(at, text.substr(1 + below(text.size() - 1, random), 1 + random.below(20)));
                break;
            case 3:
            case 4:
                text[at] = static_cast<char>(random.below(256));
                break;
            default:
                text.replace(at, 1 + random.below(3), kPieces[below(kPieces.size(), random)]);
                break;
        }
    }
    return text;
}

TEST(HostileNetworkFiles, SeedsAreRead) {
    std::set<char> readers;
    for (const std::string& text : seeds()) {
        const Verdict verdict = check_network_file(text);
        EXPECT_TRUE(verdict.accepted) << text;
        EXPECT_EQ(verdict.flaw, "") << text;
        readers.insert(text.front());
    }
    EXPECT_EQ(readers.size(), kNetworkReaders);
}

TEST(HostileNetworkFiles, AreRefusedOrGood) {
    const std::vector<std::string> texts = seeds();
    RandomStream random(StreamKey{.study = 23, .purpose = Purpose::kLinkLoss});
    std::array<int, kNetworkReaders> accepted{}, refused{};
    for (int i = 0; i < kCases; ++i) {
        const std::string text = damaged(texts[below(texts.size(), random)], random);
        const Verdict verdict = check_network_file(text);
        ASSERT_EQ(verdict.flaw, "") << "case " << i << ":\n" << text;
        ++(verdict.accepted ? accepted : refused)[static_cast<unsigned char>(text.front()) % kNetworkReaders];
    }
    // The cases are worth something only if they come to both ends.
    for (unsigned reader = 0; reader < kNetworkReaders; ++reader) {
        EXPECT_GT(accepted[reader], 10) << reader;
        EXPECT_GT(refused[reader], 50) << reader;
    }
}

}  // namespace
}  // namespace thimble
