#include "session/settings/system_settings.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/control/built_in_controllers.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "common/stale_policy.hpp"
#include "netem/packet_trace.hpp"
#include "session/records/trajectory_file.hpp"

namespace thimble {
namespace {

constexpr const char* kModalityHelp =
    "use HF (handle), CF (fingers of the acting hand), CCF (fingers of the other hand) or VF (bar on the "
    "screen)";

void read_subject(const ConfigTable& table, SessionPlan& plan) {
    std::string human, name;
    const bool is_text = table.is_text("subject");
    table.read("participant", name,
               "With subject = \"human\": P and a number, \"P07\"; --participant replaces it.");
    if (!is_text) {
        table.read("subject", plan.subject, 1, 1'000'000,
                   "Number of the virtual subject, in thimble run; or \"human\" (docs/real-subjects.md).");
        if (table.has("participant"))
            table.fail("participant", "has an effect with subject = \"human\" only");
        return;
    }
    table.read("subject", human, "");
    if (human != "human") table.fail("subject", "must be a number, or \"human\"");
    plan.kind = SubjectKind::kHuman;
    const auto participant = parse_participant(name);
    if (!participant && table.has("participant")) {
        table.fail("participant", "is \"{}\"; use P and a number, e.g. \"P07\", never a name", name);
    }
    plan.subject = participant.value_or(0);
}

void read_modalities(const ConfigTable& table, SessionPlan& plan) {
    std::vector<std::string> names;
    for (const Modality modality : plan.modalities) names.emplace_back(to_string(modality));
    table.read("modalities", names,
               "Modalities of the trials: HF, CF, CCF and VF; thimble run keeps their order.");
    plan.names_modalities = table.has("modalities");
    plan.modalities.clear();
    std::vector<std::string> unknown = names;
    std::erase_if(unknown, [](const std::string& name) { return find_modality(name).has_value(); });
    if (!unknown.empty())
        table.fail("modalities", "holds \"{}\"; {}", fmt::join(unknown, "\", \""), kModalityHelp);
    for (const std::string& name : names) {
        const auto modality = find_modality(name);
        if (std::find(plan.modalities.begin(), plan.modalities.end(), *modality) != plan.modalities.end())
            table.fail("modalities", "holds \"{}\" twice; leave one out", name);
        plan.modalities.push_back(*modality);
    }
    if (plan.modalities.empty()) table.fail("modalities", "is empty; name at least one of HF, CF, CCF, VF");
}

void add_delay(const ConfigTable& table, Duration delay, SessionPlan& plan) {
    const std::string name = delay_in_names(to_seconds(delay));
    for (const Duration other : plan.delays) {
        if (other == delay) table.fail("delays_s", "holds {} twice; leave one out", to_seconds(delay));
        if (delay_in_names(to_seconds(other)) == name)
            table.fail("delays_s", "holds {} and {}, which have the same name in files, {}; leave one out",
                       to_seconds(other), to_seconds(delay), name);
    }
    plan.delays.push_back(delay);
}

void read_delays(const ConfigTable& table, SessionPlan& plan) {
    std::vector<double> delays;
    for (const Duration delay : plan.delays) delays.push_back(to_seconds(delay));
    table.read("delays_s", delays, 0, kLongestForceDelay_s,
               "One-way delays of the force path; default: the delay of [netem.force], if it has one.");
    if (delays.empty()) table.fail("delays_s", "is empty; name at least one delay, e.g. [0.05]");
    plan.names_delays = table.has("delays_s");
    plan.delays.clear();
    for (const double delay_s : delays) add_delay(table, from_seconds(delay_s), plan);
}

SessionPlan read_plan(const ConfigTable& table) {
    SessionPlan plan;
    read_modalities(table, plan);
    read_delays(table, plan);
    table.read("seed", plan.seed, 0, INT64_MAX, "Seed of all random numbers; --seed of a study replaces it.");
    read_subject(table, plan);
    table.read("order", plan.order, kTrialOrderNames,
               "Order of a subject's trials, with [protocol] or in thimble study. shuffled: as in the paper; "
               "williams: balanced for position and carry-over.");
    table.read(
        "fixture_jitter_m", plan.fixture_jitter_m, 0, 1,
        "Half width of the uniform distribution of the fixture's position around [fixture] position_m.");
    table.read(
        "parallel_conditions", plan.parallel_conditions, 0, 64,
        "Number of delays that run at the same time; 0: one per two cores, in lock-step one per core; with "
        "a person or other machines one.");
    return plan;
}

SessionSettings read_session(const ConfigTable& trial) {
    SessionSettings s;
    trial.read("timeout_s", s.trial_timeout, 1, 3600, "Longest duration of a trial.");
    trial.read("peer_wait_s", s.peer_wait, 0.1, 600,
               "Longest wait for a program to appear, and to answer the start or end of a trial.");
    return s;
}

// Refuses values that the virtual operator and a node must share, if the file gives two.
void check_agreement(const ConfigFile& file, const SystemSettings& s) {
    const ConfigTable person = file.table("operator");
    // Refuses the key that the file has: the user can find that line.
    const auto check = [&](double value, const char* key, double node_value, const char* node,
                           const char* node_key) {
        if (value == node_value) return;
        if (person.has(key))
            person.fail(key, "is {}, but {}.{} is {}; they must be equal", value, node, node_key, node_value);
        file.table(node).fail(node_key, "is {}, but operator.{} is {}; they must be equal", node_value, key,
                              value);
    };
    check(s.person.behaviour.position_scale, "position_scale", s.master.position_scale, "master",
          "position_scale");
    check(s.person.perception.full_scale_cutaneous_N, "full_scale_cutaneous_N", s.cutaneous.force_limit_N,
          "cutaneous", "force_limit_N");
    check(s.person.perception.full_scale_bar_N, "full_scale_bar_N", s.visual.bar_full_scale_N, "visual",
          "bar_full_scale_N");
}

// Each trial presses the index finger while the needle goes in, and the thumb while it comes out.
void check_drives(const ConfigFile& file, const SystemSettings& s) {
    if (s.cutaneous.device != FingertipDevice::kDrives) return;
    const DriveSettings& drives = s.cutaneous.drives;
    for (const Modality modality : s.plan.modalities) {
        if (!s.cutaneous.presses(modality)) continue;
        const bool other = modality == Modality::kCCF;
        const Hand hand = other ? Hand::kOther : Hand::kActing;
        const bool index = drives.worn(hand, Finger::kIndex);
        if (index && drives.worn(hand, Finger::kThumb)) continue;
        const char* const key =
            index ? (other ? "other_thumb" : "acting_thumb") : (other ? "other_index" : "acting_index");
        file.table("cutaneous")
            .table("drives")
            .fail(key,
                  "is empty, but {} presses this finger: name its drives, or leave {} out of [session] "
                  "modalities",
                  to_string(modality), to_string(modality));
    }
}

void check_codec(const ConfigFile& file, const SystemSettings& s) {
    const CodecSettings& codec = s.slave.codec;
    const ConfigTable table = file.table("codec");
    const ControlSettings& control = s.master.control;
    const char* const flow = codec.command != HapticCodec::kNone ? "command" : "force";
    if (codec.used() && control.compensator == Compensator::kPlugin && has_two_ends(control))
        table.fail(flow,
                   "does not work with a plug-in that has two ends ([control] plugin), because each packet "
                   "must carry its own sample: use a plug-in with one end, or remove [codec]");
    if (codec.used() && control.compensator == Compensator::kWave)
        table.fail(flow,
                   "does not go with [control] compensator = \"wave\": each packet carries the waves of its "
                   "own sample. Use \"two-port\", or leave [codec] out");
    if (codec.command != HapticCodec::kNone) check_refresh(table, codec, "slave_sim", s.slave.stale_after);
    if (codec.force == HapticCodec::kNone) return;
    check_refresh(table, codec, "master", s.master.stale.after);
    check_refresh(table, codec, "cutaneous", s.cutaneous.stale.after);
    check_refresh(table, codec, "visual", s.visual.stale.after);
}

// Delays of a trace hold whatever the mean delay is.
bool has_traced_delay(const LinkSettings& link) {
    return link.trace != nullptr && link.trace->layout().has_delay;
}

std::string list_of(const std::vector<Duration>& delays) {
    std::vector<double> delays_s;
    delays_s.reserve(delays.size());
    for (const Duration delay : delays) delays_s.push_back(to_seconds(delay));
    return fmt::format("[{}]", fmt::join(delays_s, ", "));
}

void check_named_delays(const ConfigFile& file, const SystemSettings& s) {
    const ConfigTable session = file.table("session");
    if (has_traced_delay(s.netem.force))
        session.fail(
            "delays_s",
            fmt::format(
                "is {}, but the trace of [netem.force] gives the delays: remove delays_s, or the trace",
                list_of(s.plan.delays)));
    if (!file.table("netem").table("force").has("delay_s")) return;
    if (s.plan.delays == std::vector{s.netem.force.delay}) return;
    session.fail("delays_s", fmt::format("is {}, but netem.force.delay_s is {}: both are the delay of the "
                                         "force path, so remove one of them",
                                         list_of(s.plan.delays), to_seconds(s.netem.force.delay)));
}

// One delay of the force path for all commands, wherever the file says it.
void settle_delays(const ConfigFile& file, SystemSettings& s) {
    const ConfigTable force = file.table("netem").table("force");
    const bool undelayed = s.protocol && s.protocol->experiments != std::vector{3U};
    if (s.plan.names_delays) {
        check_named_delays(file, s);
    } else if (force.has("delay_s") || force.has("profile") || has_traced_delay(s.netem.force)) {
        if (!force.has("delay_s") && !force.has("profile")) s.netem.force.delay = mean_delay(s.netem.force);
        s.plan.names_delays = true;
        s.plan.delays = {s.netem.force.delay};
    } else if (s.protocol) {
        s.plan.delays = {undelayed ? Duration{0} : kDelayOfExperiment3};
    }
    if (!undelayed || s.plan.delays == std::vector{Duration{0}}) return;
    file.table("protocol")
        .fail("experiments",
              fmt::format("holds 1 or 2, which have no delay, but the delay of the force path is {} s: write "
                          "[3] here, or delays_s = [0.0] in [session] (and no delay_s in [netem.force])",
                          list_of(s.plan.delays)));
}

SystemSettings read_tables(const ConfigFile& file) {
    SystemSettings s;
    read_network_settings(file);
    s.runtime = read_runtime_settings(file);
    s.handle = read_handle_settings(file.table("handle"));
    s.master = read_master_settings(file, is_real(s.handle.kind) ? guard_of_real_handle() : GuardSettings{});
    s.person = read_operator_parameters(file.table("operator"));
    s.slave = read_slave_settings(file);
    s.cutaneous = read_cutaneous_settings(file.table("cutaneous"));
    s.cutaneous.hand_share = s.master.control.hand_share();
    s.protocol = read_protocol_settings(file.table("protocol"));
    if (!file.root().has("protocol")) s.protocol.reset();
    s.visual = read_visual_settings(file);
    s.pages = read_pages(file);
    s.netem = read_netem_settings(file);
    s.session = read_session(file.table("trial"));
    s.session.contact_hold = s.slave.contact_hold;
    s.plan = read_plan(file.table("session"));
    s.dataset = read_dataset_settings(file.table("dataset"));
    s.launch = read_launch_settings(file);
    s.log = read_log_settings(file);
    settle_delays(file, s);
    check_agreement(file, s);
    check_drives(file, s);
    const Duration period = s.master.sample_period;
    require_fresh_samples(file, "cutaneous", period, s.cutaneous.stale.after);
    require_fresh_samples(file, "visual", period, s.visual.stale.after);
    check_codec(file, s);
    return s;
}

ConfigFile changed_file(const std::filesystem::path& path, const std::vector<SettingChange>& changes) {
    ConfigFile file = path.empty() ? ConfigFile::empty() : ConfigFile::load(path);
    for (const SettingChange& change : changes) file.set(change.key, change.value);
    return file;
}

// Replaces the value of `key`, or appends the line if there is none, as for a key without a default.
void replace_value(std::string& parameters, const std::string& key, const std::string& value) {
    const std::string start = key + " = ";
    std::size_t at = parameters.starts_with(start) ? 0 : parameters.find('\n' + start);
    if (at == std::string::npos) {
        parameters += start + value + '\n';
        return;
    }
    at = parameters.find(start, at) + start.size();
    parameters.replace(at, parameters.find('\n', at) - at, value);
}

}  // namespace

std::optional<TrialOrder> parse_order(std::string_view text) {
    const auto* found = std::find(kTrialOrderNames.begin(), kTrialOrderNames.end(), text);
    if (found == kTrialOrderNames.end()) return std::nullopt;
    return static_cast<TrialOrder>(found - kTrialOrderNames.begin());
}

SystemSettings read_system_settings(const ConfigFile& file) {
    SystemSettings s;
    file.read_all([&] { s = read_tables(file); });
    return s;
}

std::string all_parameters(const std::filesystem::path& path, const std::vector<SettingChange>& changes,
                           const std::vector<std::pair<std::string, std::string>>& options) {
    const ConfigFile file = changed_file(path, changes);
    std::string text = file.all_values([&] { read_tables(file); });
    for (const auto& [key, value] : options) replace_value(text, key, value);
    return text;
}

SystemSettings with_force_delay(SystemSettings settings, Duration delay) {
    const Duration own = settings.netem.force.delay;
    if (delay != own && has_traced_delay(settings.netem.force))
        throw Error(
            ExitCode::kUsage,
            "a delay of {} s is asked for, but the trace of [netem.force] gives the delays: name {} s "
            "alone, or remove the trace",
            to_seconds(delay), to_seconds(own));
    set_delay(settings.netem.force, settings.netem.force_timeline, delay);
    return settings;
}

void require_simulated_devices(const SystemSettings& settings, std::string_view command) {
    const auto refuse = [command](const char* person, const char* key) {
        throw Error(ExitCode::kUsage, fmt::format("{}, but thimble {} runs virtual subjects, who hold the "
                                                  "simulated handle: remove {}, or use thimble run",
                                                  person, command, key));
    };
    if (held_by_person(settings.handle.kind)) refuse("[handle] device is for a person's hand", "device");
    if (settings.plan.kind == SubjectKind::kHuman) refuse("[session] subject is \"human\"", "subject");
    if (settings.slave.device != SlaveDevice::kSimulated)
        throw Error(ExitCode::kUsage,
                    "[slave_sim] device = \"ros2\" is a robot, which works in real time only, but thimble {} "
                    "has a clock of its own: remove device, or use thimble run",
                    command);
}

void require_virtual_subjects(const SystemSettings& settings, std::string_view command) {
    require_simulated_devices(settings, command);
    settings.launch.require_no_own_program(fmt::format("thimble {}", command));
}

SessionSettings session_settings(const SystemSettings& settings) {
    SessionSettings session = settings.session;
    const auto longest = [](const LinkSettings& start, const Timeline& timeline) {
        Duration delay = nearly_longest_delay(start);
        for (const LinkChange& change : timeline)
            delay = std::max(delay, nearly_longest_delay(change.settings));
        return delay;
    };
    session.user_limit = std::max(user_limit(settings.handle), user_limit(settings.slave));
    session.sample_period = settings.master.sample_period;
    session.force_delay = settings.netem.force.delay;
    session.least_force_delay = least_delay(settings.netem.force);
    for (const LinkChange& change : settings.netem.force_timeline)
        session.least_force_delay = std::min(session.least_force_delay, least_delay(change.settings));
    session.compensator = settings.master.control.compensator;
    session.network_delay += longest(settings.netem.needle, settings.netem.needle_timeline) +
                             longest(settings.netem.force, settings.netem.force_timeline);
    return session;
}

SystemSettings load_system_settings(const std::filesystem::path& path,
                                    const std::vector<SettingChange>& changes) {
    SystemSettings settings = read_system_settings(changed_file(path, changes));
    settings.file = path;
    return settings;
}

}  // namespace thimble
