#include <array>
#include <string>

#include "common/config.hpp"
#include "common/error.hpp"
#include "tests/fuzz/checks.hpp"

namespace thimble {
namespace {

struct Flaw {
    const char* what;
};
void require(bool holds, const char* what) {
    if (!holds) throw Flaw{what};
}

// One read must not hide the next, so each Error ends only the read that threw it.
template <class Read>
void attempt(const Read& read) {
    try {
        read();
    } catch (const Error& error) {
        require(error.code() == ExitCode::kUsage, "an Error that is not about usage");
        require(*error.what() != '\0', "an Error that says nothing");
    }
}

void read_every_way(const ConfigTable& table, std::string_view key) {
    attempt([&] {
        double value = 1;
        table.read(key, value, 0, 2, "");
        require(value >= 0 && value <= 2, "a number out of its range");
    });
    attempt([&] {
        std::int64_t value = 1;
        table.read(key, value, -3, 3, "");
        require(value >= -3 && value <= 3, "an integer out of its range");
    });
    attempt([&] {
        Duration value{1};
        table.read(key, value, 0, 5, "");
        require(value >= Duration{0} && value <= Duration{5'000'000'000}, "a duration out of its range");
    });
    attempt([&] {
        std::vector<double> values;
        table.read(key, values, -1, 1, "");
        for (const double value : values) {
            require(value >= -1 && value <= 1, "a list's number out of its range");
        }
    });
    attempt([&] {
        std::size_t chosen = 0;
        table.read(key, chosen, {"HF", "CF", "CCF", "VF"}, "");
        require(chosen < 4, "no such choice");
    });
    bool yes = false;
    std::string text;
    std::vector<std::string> texts;
    attempt([&] { table.read(key, yes, ""); });
    attempt([&] { table.read(key, text, ""); });
    attempt([&] { table.read(key, texts, ""); });
}

// Tables and keys that session files and their neighbours use, so that seeds made of them reach every type.
constexpr std::array kTables{"session",        "link",        "master", "slave_sim",
                             "cutaneous_node", "visual_node", "netem"};
constexpr std::array kKeys{"delay_s", "seed", "modalities", "fixture", "device", "port", "a"};

}  // namespace

Verdict check_config(Bytes bytes) try {
    Verdict verdict;
    attempt([&] {
        const ConfigFile file = ConfigFile::parse(std::string(text_of(bytes)), "fuzz.toml");
        for (const char* name : kTables) {
            attempt([&] {
                const ConfigTable table = file.table(name);
                for (const char* key : kKeys) read_every_way(table, key);
            });
        }
        for (const char* key : kKeys) read_every_way(file.root(), key);
        file.finish({"netem"});
        verdict.accepted = true;
    });
    return verdict;
} catch (const Flaw& flaw) {
    return {false, flaw.what};
}

}  // namespace thimble
