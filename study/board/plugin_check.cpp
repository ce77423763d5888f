#include "study/board/plugin_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/control/controller_ends.hpp"
#include "common/control/plugin.hpp"
#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/process/apart.hpp"
#include "common/random.hpp"
#include "common/runtime/import_watch.hpp"

namespace thimble {
namespace {

constexpr int kSamples = 4000, kMotions = 20;
constexpr double kMostForce_N = 20, kMostEnergy_J = 1e-9;
constexpr std::string_view kDeviceDamping = "device_damping_Ns_per_m";

struct Seen {
    int problems = 0;
    char words[240] = {};

    void say(const std::string& text) {
        if (problems++ == 0) text.copy(words, sizeof words - 1);
    }
};

// A hand that wanders about a fixture, and the force of 20 ms ago: the same for the same seed.
class DrawnHand {
  public:
    explicit DrawnHand(std::uint64_t seed) : draws_({seed, 0, 0, 0, Purpose::kLinkDelay}) {}

    double next_m() {
        if (left_-- == 0) {
            left_ = 20 + static_cast<int>(draws_.uniform() * 200);
            speed_m_per_s_ = 0.4 * (draws_.uniform() - 0.5);
        }
        if (std::fabs(position_m_ + speed_m_per_s_ * 1e-3) > 0.05) speed_m_per_s_ = -speed_m_per_s_;
        return position_m_ += speed_m_per_s_ * 1e-3;
    }
    double asked_N() { return kMostForce_N * (2 * draws_.uniform() - 1); }

  private:
    RandomStream draws_;
    int left_ = 0;
    double position_m_ = 0, speed_m_per_s_ = 0;
};

ForceFeedback feels(double force_N, double hand_m) {
    ForceFeedback feedback;
    feedback.position_needle_m = kPositionScale * hand_m;
    feedback.force_fixture_N = feedback.force_total_N = -force_N;
    return feedback;
}

// One trial of the handle's end.
class Trial {
  public:
    explicit Trial(const PluginSettings& plugin) : end_(settings_of(plugin), {}) {
        end_.start(std::chrono::milliseconds{50});
    }
    void begin_again() {
        end_.start(std::chrono::milliseconds{50});
        packet_ = {};
        before_m_ = force_N_ = 0;
    }
    HandleEnd& end() { return end_; }
    // The force of one sample, with a request that arrives just before it.
    double sample(int number, double hand_m, double asked_N) {
        const SessionTime now{std::chrono::milliseconds{number}};
        const double speed_m_per_s = number > 0 ? (hand_m - before_m_) / 1e-3 : 0;
        before_m_ = hand_m;
        end_.receive(feedback_of(feels(asked_N, hand_m), {}, 0.05));
        if (end_.has(THIMBLE_BOTH_ENDS)) end_.receive(packet_);
        packet_ = end_.sample(now, hand_m, speed_m_per_s, force_N_);
        return force_N_ = std::clamp(end_.force_N(), -kHandleFullScale_N, kHandleFullScale_N);
    }
    static ControlSettings settings_of(const PluginSettings& plugin) {
        ControlSettings settings;
        settings.compensator = Compensator::kPlugin;
        settings.plugin = plugin;
        return settings;
    }

  private:
    HandleEnd end_;
    WaveBurst packet_;
    double before_m_ = 0, force_N_ = 0;
};

// The slave's end, moved by the same hand.
class SlaveTrial {
  public:
    explicit SlaveTrial(const PluginSettings& plugin) : end_(Trial::settings_of(plugin), {}) { end_.start(); }
    double sample(int number, double hand_m, double felt_N) {
        NeedleWave message;
        message.command.position_hand_m = hand_m;
        message.waves.number = static_cast<std::uint32_t>(number);
        message.waves.count = 1;
        for (std::uint32_t left = end_.receive(message, true); left > 0; --left)
            position_m_ = end_.step_hand_m({0.02, 3000, felt_N});
        burst_ = end_.answer(feedback_of(feels(felt_N, position_m_), {}, 0));
        return position_m_ + burst_.wave_root_W[0];
    }
    ControllerTally tally() const { return end_.tally(); }

  private:
    SlaveEnd end_;
    WaveBurst burst_;
    double position_m_ = 0;
};

bool two_ends(const PluginSettings& plugin) { return (plugin.table->capabilities & THIMBLE_BOTH_ENDS) != 0; }

std::vector<double> forces_of(Trial& trial, std::uint64_t seed, int samples) {
    DrawnHand hand(seed);
    std::vector<double> forces;
    forces.reserve(static_cast<std::size_t>(samples));
    for (int i = 0; i < samples; ++i) {
        const double hand_m = hand.next_m();
        forces.push_back(trial.sample(i, hand_m, hand.asked_N()));
    }
    return forces;
}

Seen look_at_imports(const PluginSettings& plugin) {
    Seen seen;
    Trial trial(plugin);
    std::optional<SlaveTrial> slave;
    if (two_ends(plugin)) slave.emplace(plugin);
    DrawnHand hand(1);
    if (!watch_imports()) seen.say("the plug-in's imports cannot be watched on this system");
    for (int i = 0; i < kSamples; ++i) {
        const double hand_m = hand.next_m(), asked_N = hand.asked_N();
        const ImportWatch watch;
        trial.sample(i, hand_m, asked_N);
        if (slave) slave->sample(i, hand_m, asked_N);
    }
    const ImportCounts counts = ImportWatch::counts();
    if (counts.allocations > 0)
        seen.say(fmt::format("it asked for or released memory {} times in {} samples", counts.allocations,
                             kSamples));
    if (counts.clocks > 0)
        seen.say(fmt::format("it read a clock {} times in {} samples", counts.clocks, kSamples));
    if (counts.files > 0) seen.say(fmt::format("it opened, read or wrote a file {} times", counts.files));
    return seen;
}

Seen look_at_range(const PluginSettings& plugin) {
    Seen seen;
    Trial trial(plugin);
    DrawnHand hand(2);
    for (int i = 0; i < kSamples; ++i) {
        const double hand_m = hand.next_m();
        trial.sample(i, hand_m, hand.asked_N());
        // As it is, before the master cuts it off.
        const double force_N = trial.end().force_N();
        if (std::fabs(force_N) > 100 * kHandleFullScale_N)
            seen.say(fmt::format("force() gave {:g} N in sample {}, of a handle with {:g} N", force_N, i,
                                 kHandleFullScale_N));
    }
    if (trial.end().tally().not_numbers > 0)
        seen.say(
            fmt::format("{} values in {} samples are no numbers", trial.end().tally().not_numbers, kSamples));
    return seen;
}

Seen look_at_hostile(const PluginSettings& plugin) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    const std::array hostile{0.0, -0.0, kNone, kInfinite, -kInfinite, 1e300, -1e300, 5e-324};
    Seen seen;
    for (const double position : hostile) {
        for (const double force : hostile) {
            Trial trial(plugin);
            for (int i = 0; i < 30; ++i) trial.sample(i, 0.01, 2);
            for (int i = 30; i < 40; ++i) trial.sample(i, position, force);
            trial.sample(40, 0.01, 2);
            trial.end().forget();
            trial.sample(20, 0.01, 2);  // a clock that went back
            if (trial.end().tally().not_numbers > 0)
                seen.say(fmt::format(
                    "with the hand at {:g} m and a force of {:g} N it gives values that are no numbers",
                    position, force));
        }
    }
    return seen;
}

Seen look_at_sameness(const PluginSettings& plugin) {
    Seen seen;
    Trial alone(plugin), one(plugin), other(plugin);
    const std::vector<double> expected = forces_of(alone, 3, kSamples);
    DrawnHand hand(3), others(4);
    for (int i = 0; i < kSamples; ++i) {
        const double hand_m = hand.next_m(), asked_N = hand.asked_N();
        other.sample(i, others.next_m(), others.asked_N());
        if (one.sample(i, hand_m, asked_N) == expected[static_cast<std::size_t>(i)]) continue;
        seen.say(fmt::format("two ends with the same inputs give other forces from sample {} on", i));
        break;
    }
    return seen;
}

Seen look_at_new_trials(const PluginSettings& plugin) {
    Seen seen;
    Trial fresh(plugin), used(plugin);
    forces_of(used, 5, kSamples);
    used.begin_again();
    const std::vector<double> expected = forces_of(fresh, 6, kSamples), given = forces_of(used, 6, kSamples);
    const auto differs = std::mismatch(expected.begin(), expected.end(), given.begin()).first;
    if (differs != expected.end())
        seen.say(
            fmt::format("after start() sample {} depends on the trial before", differs - expected.begin()));
    return seen;
}

double damping_of(const PluginSettings& plugin) {
    for (std::uint32_t i = 0; i < plugin.table->key_count; ++i)
        if (plugin.table->keys[i].name == kDeviceDamping) return plugin.values[i];
    return 0;
}

// The energy that the hand put in, with the device's damping, after each sample of drawn motions.
Seen look_at_energy(const PluginSettings& plugin) {
    Seen seen;
    const double damping_Ns_per_m = damping_of(plugin);
    for (std::uint64_t seed = 1; seed <= kMotions; ++seed) {
        Trial trial(plugin);
        DrawnHand hand(seed);
        double energy_J = 0, least_J = 0, before_m = 0, force_N = 0;
        for (int i = 0; i < kSamples; ++i) {
            const double hand_m = hand.next_m();
            const double travel_m = i > 0 ? hand_m - before_m : 0;
            energy_J += force_N * travel_m + damping_Ns_per_m * travel_m * travel_m / 1e-3;
            least_J = std::min(least_J, energy_J);
            before_m = hand_m;
            force_N = trial.sample(i, hand_m, hand.asked_N());
        }
        if (least_J < -kMostEnergy_J)
            seen.say(
                fmt::format("it gave out {:.3g} J more than it got in a drawn motion (seed {}, {:g} Ns/m)",
                            -least_J, seed, damping_Ns_per_m));
    }
    return seen;
}

struct Probe {
    const char* rule;
    const char* tried;
    Seen (*look)(const PluginSettings&);
};

constexpr Probe kProbes[] = {
    {"asks for no memory, clock or file after create", "4,000 samples were watched", look_at_imports},
    {"stays in range", "4,000 samples", look_at_range},
    {"gives numbers for hostile input", "64 pairs of NaN, infinite, huge and tiny values", look_at_hostile},
    {"gives the same forces for the same inputs", "three ends side by side", look_at_sameness},
    {"forgets with start()", "a trial after another", look_at_new_trials},
    {"is passive, as it says", "20 drawn motions", look_at_energy},
};

PluginFinding finding_of(const Probe& probe, const PluginSettings& plugin, Duration limit) {
    const ApartResult apart = run_apart([&] { return bytes_of(probe.look(plugin)); }, limit);
    if (!apart.bytes) return {probe.rule, false, apart.failure};
    std::string_view bytes = *apart.bytes;
    const Seen seen = take_plain<Seen>(bytes);
    return {probe.rule, seen.problems == 0, seen.problems == 0 ? probe.tried : seen.words};
}

// A constructor of the library may crash, so the first time is in a copy as well.
std::optional<PluginSettings> loaded(const std::filesystem::path& file, Duration limit, PluginCheck& check) {
    const ApartResult apart = run_apart([&] { return std::string(load_plugin(file).table->name); }, limit);
    check.findings.push_back({"can be loaded", apart.bytes.has_value(),
                              apart.bytes ? "version and functions are there" : apart.failure});
    if (!apart.bytes) return std::nullopt;
    check.name = *apart.bytes;
    return load_plugin(file);
}

}  // namespace

bool PluginCheck::good() const {
    return std::all_of(findings.begin(), findings.end(), [](const PluginFinding& f) { return f.kept; });
}

std::string PluginCheck::text() const {
    std::string text = fmt::format("{}{}{}\n", file, name.empty() ? "" : ": ", name);
    for (const PluginFinding& f : findings)
        text += fmt::format("  {:<5}{}: {}\n", f.kept ? "ok" : "BAD", f.rule, f.words);
    return text;
}

std::string PluginCheck::json() const {
    nlohmann::ordered_json all{{"file", file}, {"name", name}, {"good", good()}};
    for (const PluginFinding& f : findings)
        all["findings"].push_back({{"rule", f.rule}, {"kept", f.kept}, {"words", f.words}});
    return json_text(all, 2);
}

PluginCheck check_plugin(const std::filesystem::path& file, const std::vector<double>& values,
                         Duration limit) {
    PluginCheck check;
    check.file = file.string();
    std::optional<PluginSettings> plugin = loaded(file, limit, check);
    if (!plugin) return check;
    std::copy_n(values.begin(), std::min(values.size(), plugin->values.size()), plugin->values.begin());
    const bool passive = (plugin->table->capabilities & THIMBLE_PASSIVE) != 0;
    for (const Probe& probe : kProbes) {
        if (probe.look == look_at_energy && !passive) continue;
        check.findings.push_back(finding_of(probe, *plugin, limit));
        if (check.findings.back().words.find("took longer") != std::string::npos) break;
    }
    return check;
}

}  // namespace thimble
