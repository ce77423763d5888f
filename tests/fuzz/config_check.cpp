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
        const double value = table.number(key, 1, 0, 2);
        require(value >= 0 && value <= 2, "a number out of its range");
    });
    attempt([&] {
        const std::int64_t value = table.integer(key, 1, -3, 3);
        require(value >= -3 && value <= 3, "an integer out of its range");
    });
    attempt([&] {
        const Duration value = table.seconds(key, Duration{1}, Duration{0}, Duration{5'000'000'000});
        require(value >= Duration{0} && value <= Duration{5'000'000'000}, "a duration out of its range");
    });
    attempt([&] {
        for (const double value : table.numbers(key, {}, -1, 1)) {
            require(value >= -1 && value <= 1, "a list's number out of its range");
        }
    });
    attempt([&] { require(table.choice(key, 0, {"HF", "CF", "CCF", "VF"}) < 4, "no such choice"); });
    attempt([&] { table.boolean(key, false); });
    attempt([&] { table.text(key, ""); });
    attempt([&] { table.texts(key, {}); });
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
