// Good input, damaged as editors, networks and attackers do: what is still read must be as promised. The seeded little sister of the
// fuzzers, for every build and every compiler.
#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "common/random.hpp"
#include "common/security/key_ring.hpp"
#include "common/security/sealing.hpp"
#include "tests/fuzz/checks.hpp"
#include "tests/read_text.hpp"
#include "tests/unit/hid/fake_hid.hpp"

namespace thimble {
namespace {

using Check = Verdict (*)(Bytes);
using Octets = std::vector<std::uint8_t>;

std::uint32_t below(std::size_t n, RandomStream& random) {
    return random.below(static_cast<std::uint32_t>(n));
}

// Seeds, which the check accepts.
std::vector<std::string> good_files_in(const std::string& folder, Check check) {
    std::set<std::filesystem::path> paths;  // a folder has no order of its own
    for (const auto& entry : std::filesystem::directory_iterator(THIMBLE_SOURCE_DIR "/" + folder))
        paths.insert(entry.path());
    std::vector<std::string> texts;
    for (const auto& path : paths) {
        texts.push_back(read_text(path));
        const Verdict verdict = check(bytes_of_text(texts.back()));
        EXPECT_TRUE(verdict.accepted) << path;
        EXPECT_EQ(verdict.flaw, "") << path;
    }
    return texts;
}

bool in_number(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.'; }

// Mostly the text after an = or a comma, where numbers are.
void set_number(std::string& text, RandomStream& random) {
    constexpr std::array kNumbers{"0",     "1",     "-1",   "-0.0",   "0.02",  "1e-15",
                                  "1e-12", "1e-9",  "1e-6", "1e-3",   "1e3",   "1e6",
                                  "1e9",   "1e12",  "1e13", "5e-324", "1e300", "nan",
                                  "-inf",  "1e999", "+0.5", "",       "0x1",   "0.0200000000000000003",
                                  "100%",  "1ms"};
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

// The line at `at` with its end, and where it begins.
std::string line_at(const std::string& text, std::size_t at, std::size_t& first) {
    first = text.rfind('\n', at) + 1;  // npos + 1 is the beginning
    if (text[at] == '\n') first = at;
    return text.substr(first, text.find('\n', at) - first) + '\n';
}

// One to three wounds, mostly to numbers: a file that is damaged too much is refused at the first look.
std::string damaged(const std::vector<std::string>& seeds, RandomStream& random) {
    std::string text = seeds[below(seeds.size(), random)];
    for (std::uint32_t n = 1 + random.below(3); n > 0 && !text.empty(); --n) {
        const std::uint32_t wound = random.below(16);
        std::size_t first = 0;
        if (wound == 0) text.resize(below(text.size(), random));
        if (wound == 1) text += seeds[below(seeds.size(), random)];
        if (wound == 2 || wound == 3) {
            const std::string line = line_at(text, below(text.size(), random), first);
            wound == 2 ? text.erase(first, line.size()) : text.insert(first, line);
        }
        if (wound == 4 || wound == 5) set_byte(text, random);
        if (wound > 5) set_number(text, random);
    }
    return text;
}

// The same for a file of bytes.
std::string damaged_bytes(const std::vector<std::string>& seeds, RandomStream& random) {
    std::string bytes = seeds[below(seeds.size(), random)];
    for (std::uint32_t n = 1 + random.below(3); n > 0 && !bytes.empty(); --n) {
        const std::size_t at = below(bytes.size(), random);
        const std::uint32_t wound = random.below(8);
        if (wound == 0) bytes.resize(at);
        if (wound == 1) bytes.erase(at, 1 + random.below(8));
        if (wound > 1) bytes[at] = static_cast<char>(random.below(256));
    }
    return bytes;
}

struct TextInput {
    const char* name;
    const char* seeds;
    int cases;
    Check check;
};
void PrintTo(const TextInput& input, std::ostream* out) { *out << input.name; }

class HostileFiles : public testing::TestWithParam<TextInput> {};
INSTANTIATE_TEST_SUITE_P(All, HostileFiles,
                         testing::Values(TextInput{"needle", "tests/fuzz/seeds_needle", 20'000, check_needle},
                                         TextInput{"recorded", "tests/fuzz/seeds_recorded", 2'000,
                                                   check_recorded},
                                         TextInput{"scene", "deploy/scenes", 10'000, check_scene}),
                         testing::PrintToStringParamName());

TEST_P(HostileFiles, SeedsAreReadAndDamagedOnesRefusedOrGood) {
    const std::vector<std::string> seeds = good_files_in(GetParam().seeds, GetParam().check);
    ASSERT_GE(seeds.size(), 5u);
    RandomStream random(StreamKey{.study = 22, .purpose = Purpose::kLinkLoss});
    int accepted = 0;
    for (int i = 0; i < GetParam().cases; ++i) {
        const std::string text = damaged(seeds, random);
        const Verdict verdict = GetParam().check(bytes_of_text(text));
        ASSERT_EQ(verdict.flaw, "") << "case " << i << ":\n" << text;
        accepted += verdict.accepted ? 1 : 0;
    }
    // The cases are worth something only if they come to both ends.
    EXPECT_GT(accepted, GetParam().cases / 10);
    EXPECT_LT(accepted, GetParam().cases * 9 / 10);
}

TEST(HostileNetworkFiles, SeedsAreReadAndDamagedOnesRefusedOrGood) {
    std::map<char, std::vector<std::string>> seeds;  // by the reader, which the first byte chooses
    for (const std::string& text : good_files_in("tests/fuzz/seeds_network", check_network_files))
        seeds[text.front()].push_back(text.substr(1));
    ASSERT_EQ(seeds.size(), kNetworkReaders);
    RandomStream random(StreamKey{.study = 23, .purpose = Purpose::kLinkLoss});
    for (const auto& [reader, texts] : seeds) {
        int accepted = 0, refused = 0;
        for (int i = 0; i < 2'500; ++i) {
            const auto damage =
                reader == '4' || reader == '8' ? damaged_bytes : damaged;  // these are no text
            const std::string text = reader + damage(texts, random);
            const Verdict verdict = check_network_files(bytes_of_text(text));
            ASSERT_EQ(verdict.flaw, "") << "case " << i << ":\n" << text;
            ++(verdict.accepted ? accepted : refused);
        }
        EXPECT_GT(accepted, 10) << reader;
        EXPECT_GT(refused, 50) << reader;
    }
}

TEST(HostileNetworkFiles, SlotsMayBeWiderThanTheirMean) {
    const Verdict verdict = check_network_files(bytes_of_text("0slot distribution pareto 1ms 2ms"));
    EXPECT_TRUE(verdict.accepted);
    EXPECT_EQ(verdict.flaw, "");
}

// How many of these inputs were accepted. No input may break a promise.
int accepted_of(int count, Check check, const std::function<Octets(int, RandomStream&)>& input) {
    RandomStream random({3, 0, 0, 0, Purpose::kInstance});
    int accepted = 0;
    for (int i = 0; i < count; ++i) {
        const Verdict verdict = check(input(i, random));
        EXPECT_EQ(verdict.flaw, "") << i;
        accepted += verdict.accepted ? 1 : 0;
    }
    return accepted;
}

Octets noise(std::size_t size, RandomStream& random) {
    Octets bytes(size);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    return bytes;
}

TEST(HostileCan, NonsenseNeitherCrashesNorPresses) {
    accepted_of(300, check_can, [](int i, RandomStream& random) {
        Octets bytes = noise(random.below(400), random);
        if (i % 2 == 0 && bytes.size() > 5) {  // deeper into the datagrams
            bytes[0] = 2;
            bytes[1] = bytes[3] = 0;
        }
        return bytes;
    });
}

// A gamepad's descriptor and its reports.
TEST(HostileHid, NothingThatADeviceSaysDoesHarm) {
    Octets whole{static_cast<std::uint8_t>(test::kGamepadDescriptor.size())};
    whole.insert(whole.end(), test::kGamepadDescriptor.begin(), test::kGamepadDescriptor.end());
    RandomStream fresh(StreamKey{.study = 1});
    const Octets reports = noise(40, fresh);
    whole.insert(whole.end(), reports.begin(), reports.end());
    EXPECT_TRUE(check_hid(whole).accepted);
    const int accepted = accepted_of(20'000, check_hid, [&](int, RandomStream& random) {
        Octets damaged = whole;
        for (std::uint32_t n = 1 + random.below(3); n > 0; --n)
            damaged[below(damaged.size(), random)] = static_cast<std::uint8_t>(random());
        return damaged;
    });
    EXPECT_GT(accepted, 1000);
    EXPECT_LT(accepted, 19'000);
}

// The scripts get somewhere.
TEST(HostileSecurity, RandomScriptsOnTheHandshake) {
    EXPECT_GT(accepted_of(300, check_handshake,
                          [](int, RandomStream& random) { return noise(random.below(200), random); }),
              50);
}

TEST(HostileSecurity, RandomScriptsAtTheStopBus) {
    for (const bool open : {false, true}) {
        const int stopped = accepted_of(300, check_stop, [open](int, RandomStream& random) {
            Octets script = noise(1 + random.below(100), random);
            script[0] = open ? 1 : 0;
            return script;
        });
        EXPECT_GT(stopped, open ? -1 : 50);
    }
}

TEST(HostileSecurity, ChangedDatagramsAndWordsAboutKeys) {
    KeyGrant grant;
    grant.count = 3;
    for (std::size_t k = 0; k < grant.count; ++k) grant.keys[k].keyed = {Port::kSlaveNeedle, k == 1};
    KeyText text{};
    const Bytes good = write_grant(grant, text);
    const int accepted = accepted_of(20'000, check_sealed, [&](int i, RandomStream& random) {
        Octets bytes(good.begin(), good.end());
        if (i % 2 == 0) {
            write_seal_header({PacketKind::kData, Port::kSlaveNeedle, 0, 1},
                              std::span(bytes).first<kSealHeaderBytes>());
        }
        bytes[below(bytes.size(), random)] ^= static_cast<std::uint8_t>(random());
        return bytes;
    });
    EXPECT_GT(accepted, 1000);
}

}  // namespace
}  // namespace thimble
