#include "study/board/plugin_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/control/control_settings.hpp"
#include "common/control/controller_ends.hpp"
#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/process/isolated.hpp"
#include "common/random.hpp"
#include "common/runtime/import_watch.hpp"
#include "common/runtime/plugin_watch.hpp"

namespace thimble {
namespace {

constexpr int kSamples = 4000, kMotions = 20;
constexpr double kMostForce_N = 20, kMostEnergy_J = 1e-9, kMostPosition_m = 10;
// A whole probe may take this long: an interpreter on a busy machine answers 200,000 calls slowly.
constexpr Duration kProbeLimit = std::chrono::minutes{10};
constexpr std::string_view kTookLonger = "took longer";  // as run_isolated() says it
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

// Outputs of both ends in one sample.
struct Given {
    double force_N = 0, position_m = 0, from_handle_root_W = 0, from_slave_root_W = 0;
    bool operator==(const Given&) const = default;
};

// One trial of a plug-in: the handle's end and, where it has one, the slave's end. The same hand moves both.
class Trial {
  public:
    explicit Trial(const PluginSettings& plugin) : end_(settings_of(plugin), {}) {
        if (end_.has(THIMBLE_BOTH_ENDS)) slave_.emplace(settings_of(plugin), HandleControlScale{});
        begin_again();
    }
    void begin_again() {
        end_.start(std::chrono::milliseconds{50});
        if (slave_) slave_->start();
        packet_ = {};
        given_ = {};
        before_m_ = 0;
    }
    HandleEnd& end() { return end_; }
    // A request arrives just before the sample, and as a force at the slave.
    Given sample(int number, double hand_m, double asked_N) {
        sample_handle(number, hand_m, asked_N);
        if (slave_) sample_slave(number, hand_m, asked_N);
        return given_;
    }
    std::uint64_t not_numbers() const {
        return end_.tally().not_numbers + (slave_ ? slave_->tally().not_numbers : 0);
    }

  private:
    static ControlSettings settings_of(const PluginSettings& plugin) {
        ControlSettings settings;
        settings.compensator = Compensator::kPlugin;
        settings.plugin = plugin;
        return settings;
    }
    void sample_handle(int number, double hand_m, double asked_N) {
        const SessionTime now{std::chrono::milliseconds{number}};
        const double speed_m_per_s = number > 0 ? (hand_m - before_m_) / 1e-3 : 0;
        before_m_ = hand_m;
        end_.receive(feedback_of(feels(asked_N, hand_m), {}, 0.05));
        if (slave_) end_.receive(packet_);
        packet_ = end_.sample(now, hand_m, speed_m_per_s, given_.force_N);
        given_.from_handle_root_W = packet_.wave_root_W[0];
        given_.force_N = std::clamp(end_.force_N(), -kHandleFullScale_N, kHandleFullScale_N);
    }
    void sample_slave(int number, double hand_m, double felt_N) {
        NeedleWave message;
        message.command.position_hand_m = hand_m;
        message.waves.number = static_cast<std::uint32_t>(number);
        message.waves.count = 1;
        for (std::uint32_t left = slave_->receive(message, true); left > 0; --left)
            given_.position_m = slave_->step_hand_m({0.02, 3000, felt_N});
        const ForceFeedback felt = feels(felt_N, given_.position_m);
        given_.from_slave_root_W = slave_->answer(feedback_of(felt, {}, 0)).wave_root_W[0];
    }

    HandleEnd end_;
    std::optional<SlaveEnd> slave_;
    WaveBurst packet_;
    Given given_;
    double before_m_ = 0;
};

std::vector<Given> trial_of(Trial& trial, std::uint64_t seed, int samples) {
    DrawnHand hand(seed);
    std::vector<Given> all;
    all.reserve(static_cast<std::size_t>(samples));
    for (int i = 0; i < samples; ++i) {
        const double hand_m = hand.next_m();
        all.push_back(trial.sample(i, hand_m, hand.asked_N()));
    }
    return all;
}

Seen look_at_imports(const PluginSettings& plugin) {
    Seen seen;
    Trial trial(plugin);
    DrawnHand hand(1);
    if (!watch_imports()) seen.say("its calls to the system cannot be watched on this machine");
    for (int i = 0; i < kSamples; ++i) {
        const double hand_m = hand.next_m(), asked_N = hand.asked_N();
        const ImportWatch watch;
        trial.sample(i, hand_m, asked_N);
    }
    const ImportCounts counts = ImportWatch::counts();
    if (counts.allocations > 0)
        seen.say(
            fmt::format("it allocated or freed memory {} times in {} samples", counts.allocations, kSamples));
    if (counts.clocks > 0)
        seen.say(fmt::format("it read a clock {} times in {} samples", counts.clocks, kSamples));
    if (counts.files > 0)
        seen.say(fmt::format("it used a file or the system's random numbers {} times", counts.files));
    return seen;
}

Seen look_at_range(const PluginSettings& plugin) {
    Seen seen;
    Trial trial(plugin);
    DrawnHand hand(2);
    for (int i = 0; i < kSamples; ++i) {
        const double hand_m = hand.next_m();
        const Given given = trial.sample(i, hand_m, hand.asked_N());
        // The raw force, before the master clips it.
        const double force_N = trial.end().force_N();
        if (std::fabs(force_N) > 100 * kHandleFullScale_N)
            seen.say(fmt::format("force() returned {:g} N in sample {}; the handle has at most {:g} N",
                                 force_N, i, kHandleFullScale_N));
        if (std::fabs(given.position_m) > kMostPosition_m)
            seen.say(fmt::format("step_slave() returned {:g} m in sample {}; the limit is {:g} m",
                                 given.position_m, i, kMostPosition_m));
    }
    if (const std::uint64_t count = trial.not_numbers(); count > 0)
        seen.say(fmt::format("{} values in {} samples are not finite numbers", count, kSamples));
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
            if (trial.not_numbers() > 0)
                seen.say(
                    fmt::format("with the hand at {:g} m and a force of {:g} N it returns values that are "
                                "not finite numbers",
                                position, force));
        }
    }
    return seen;
}

Seen look_at_sameness(const PluginSettings& plugin) {
    Seen seen;
    Trial alone(plugin), one(plugin), other(plugin);
    const std::vector<Given> expected = trial_of(alone, 3, kSamples);
    DrawnHand hand(3), others(4);
    for (int i = 0; i < kSamples; ++i) {
        const double hand_m = hand.next_m(), asked_N = hand.asked_N();
        other.sample(i, others.next_m(), others.asked_N());
        if (one.sample(i, hand_m, asked_N) == expected[static_cast<std::size_t>(i)]) continue;
        seen.say(
            fmt::format("two instances with the same inputs return different values from sample {} on", i));
        break;
    }
    return seen;
}

Seen look_at_new_trials(const PluginSettings& plugin) {
    Seen seen;
    Trial fresh(plugin), used(plugin);
    trial_of(used, 5, kSamples);
    used.begin_again();
    const std::vector<Given> expected = trial_of(fresh, 6, kSamples), given = trial_of(used, 6, kSamples);
    const auto differs = std::mismatch(expected.begin(), expected.end(), given.begin()).first;
    if (differs != expected.end())
        seen.say(
            fmt::format("after start(), sample {} depends on the trial before", differs - expected.begin()));
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
            force_N = trial.sample(i, hand_m, hand.asked_N()).force_N;
        }
        if (least_J < -kMostEnergy_J)
            seen.say(fmt::format(
                "it gave out {:.3g} J more than it received in a random motion (seed {}, {:g} Ns/m)",
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
    {"gives the same values for the same inputs", "three instances side by side", look_at_sameness},
    {"forgets with start()", "one trial after another", look_at_new_trials},
    {"is passive, as it says", "20 random motions", look_at_energy},
};

Seen look_in_time(const Probe& probe, const PluginSettings& plugin, Duration limit) {
    PluginWatch watch;
    watch.expect(limit);
    return probe.look(plugin);
}

// Of a call that hangs, the watch's signal has ended the copy: its number tells less than the limit.
std::string why_failed(const std::string& failure, Duration limit) {
    const bool hung = failure.find("did not return from") != std::string::npos;
    if (!hung || failure.find(kTookLonger) != std::string::npos) return failure;
    return fmt::format("{}; it {} than {} s", failure.substr(0, failure.find("; signal")), kTookLonger,
                       to_seconds(limit));
}

PluginFinding finding_of(const Probe& probe, const PluginSettings& plugin, Duration limit) {
    const IsolatedResult apart =
        run_isolated([&] { return bytes_of(look_in_time(probe, plugin, limit)); }, kProbeLimit);
    if (!apart.bytes) return {probe.rule, false, why_failed(apart.failure, limit)};
    std::string_view bytes = *apart.bytes;
    const Seen seen = take_plain<Seen>(bytes);
    return {probe.rule, seen.problems == 0, seen.problems == 0 ? probe.tried : seen.words};
}

// A constructor of the library may crash, so the first time is in a copy as well.
std::optional<PluginSettings> loaded(const std::filesystem::path& file, PluginCheck& check) {
    const IsolatedResult apart = run_isolated([&] { return std::string(load_plugin(file).table->name); });
    check.findings.push_back({"can be loaded", apart.bytes.has_value(),
                              apart.bytes ? "version and functions are right" : apart.failure});
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
        text += fmt::format("  {:<5}{}: {}\n", f.kept ? "ok" : "FAIL", f.rule, f.words);
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
    std::optional<PluginSettings> plugin = loaded(file, check);
    if (!plugin) return check;
    std::copy_n(values.begin(), std::min(values.size(), plugin->values.size()), plugin->values.begin());
    const bool passive = (plugin->table->capabilities & THIMBLE_PASSIVE) != 0;
    for (const Probe& probe : kProbes) {
        if (probe.look == look_at_energy && !passive) continue;
        check.findings.push_back(finding_of(probe, *plugin, limit));
        if (check.findings.back().words.find(kTookLonger) != std::string::npos) break;
    }
    return check;
}

}  // namespace thimble
