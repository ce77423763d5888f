#include "session/settings/system_settings.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "common/network_settings.hpp"
#include "common/runtime/runtime_settings.hpp"

namespace thimble {
namespace {

constexpr const char* kModalityHelp =
    "use HF (handle), CF (fingers of the acting hand), CCF (fingers of the other hand) or VF (bar on the "
    "screen)";

void read_subject(const ConfigTable& table, SessionPlan& plan) {
    std::string human, name;
    const bool is_text = table.is_text("subject");
    table.read("participant", name, "Of subject = \"human\": P and a number, \"P07\"; or --participant.");
    if (!is_text) {
        table.read("subject", plan.subject, 1, 1'000'000,
                   "Which virtual subject, in thimble run; or \"human\" (docs/real-subjects.md).");
        if (table.has("participant")) table.fail("participant", "is of subject = \"human\" only");
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
    table.read("modalities", names, "Trials of thimble run, in this order: of HF, CF, CCF and VF.");
    plan.modalities.clear();
    for (const std::string& name : names) {
        const auto modality = find_modality(name);
        if (!modality) table.fail("modalities", "holds \"{}\"; {}", name, kModalityHelp);
        plan.modalities.push_back(*modality);
    }
    if (plan.modalities.empty()) table.fail("modalities", "is empty; name at least one of HF, CF, CCF, VF");
}

SessionPlan read_plan(const ConfigTable& table) {
    SessionPlan plan;
    read_modalities(table, plan);
    std::vector<double> delays;
    for (const Duration delay : plan.delays) delays.push_back(to_seconds(delay));
    table.read("delays_s", delays, 0, 60,
               "One-way delays of the force path; each replaces [netem.force] delay_s.");
    if (delays.empty()) table.fail("delays_s", "is empty; name at least one delay, e.g. [0.05]");
    plan.delays.clear();
    for (const double delay_s : delays) plan.delays.push_back(from_seconds(delay_s));
    table.read("seed", plan.seed, 0, INT64_MAX, "Of thimble run; thimble study takes --seed.");
    read_subject(table, plan);
    table.read(
        "order", plan.order, kTrialOrderNames,
        "Of a subject's trials in thimble study: as in the paper, or balanced for position and carry-over.");
    table.read("fixture_jitter_m", plan.fixture_jitter_m, 0, 1,
               "Half width of the uniform draw of the fixture around [fixture] position_m.");
    table.read("parallel_conditions", plan.parallel_conditions, 0, 64,
               "Delays run side by side; 0: one per two cores, with other machines one.");
    return plan;
}

SessionSettings read_session(const ConfigTable& trial) {
    SessionSettings s;
    trial.read("timeout_s", s.trial_timeout, 1, 3600, "A trial that takes longer is ended.");
    trial.read("peer_wait_s", s.peer_wait, 0.1, 600,
               "For a node to appear, and to answer a start or an end.");
    return s;
}

// The virtual operator knows the instruments it works with; a file that describes two different ones is a
// mistake.
void check_agreement(const ConfigFile& file, const SystemSettings& s) {
    const auto check = [&](double operator_value, double node_value, const char* key, const char* node_key) {
        if (operator_value == node_value) return;
        file.table("operator")
            .fail(key, fmt::format("is {}, but {} is {}; they must be equal", operator_value, node_key,
                                   node_value));
    };
    check(s.person.behaviour.position_scale, s.master.position_scale, "position_scale",
          "master.position_scale");
    check(s.person.perception.full_scale_cutaneous_N, s.cutaneous.force_limit_N, "full_scale_cutaneous_N",
          "cutaneous.force_limit_N");
    check(s.person.perception.full_scale_bar_N, s.visual.bar_full_scale_N, "full_scale_bar_N",
          "visual.bar_full_scale_N");
}

}  // namespace

std::optional<TrialOrder> parse_order(std::string_view text) {
    const auto* found = std::find(kTrialOrderNames.begin(), kTrialOrderNames.end(), text);
    if (found == kTrialOrderNames.end()) return std::nullopt;
    return static_cast<TrialOrder>(found - kTrialOrderNames.begin());
}

SystemSettings read_system_settings(const ConfigFile& file) {
    SystemSettings s;
    read_network_settings(file);
    s.runtime = read_runtime_settings(file);
    s.master = read_master_settings(file);
    s.handle = read_handle_settings(file.table("handle"));
    s.person = read_operator_parameters(file.table("operator"));
    s.slave = read_slave_settings(file);
    s.cutaneous = read_cutaneous_settings(file.table("cutaneous"));
    s.cutaneous.hand_share = s.master.control.hand_share();
    s.protocol = read_protocol_settings(file.table("protocol"));
    if (!file.root().has("protocol")) s.protocol.reset();
    s.visual = read_visual_settings(file);
    s.instructions = read_instructions(file.table("instructions"));
    s.netem = read_netem_settings(file);
    s.session = read_session(file.table("trial"));
    s.session.contact_hold = s.slave.contact_hold;
    s.plan = read_plan(file.table("session"));
    s.dataset = read_dataset_settings(file.table("dataset"));
    s.launch = read_launch_settings(file);
    s.log = read_log_settings(file);
    check_agreement(file, s);
    file.finish();
    return s;
}

SessionSettings session_settings(const SystemSettings& settings) {
    SessionSettings session = settings.session;
    const auto longest = [](const LinkSettings& start, const Timeline& timeline) {
        Duration delay = nearly_longest_delay(start);
        for (const LinkChange& change : timeline)
            delay = std::max(delay, nearly_longest_delay(change.settings));
        return delay;
    };
    session.user_limit = user_limit(settings.handle);
    session.sample_period = settings.master.sample_period;
    session.force_delay = settings.netem.force.delay;
    session.compensator = settings.master.control.compensator;
    session.network_delay += longest(settings.netem.needle, settings.netem.needle_timeline) +
                             longest(settings.netem.force, settings.netem.force_timeline);
    return session;
}

SystemSettings load_system_settings(const std::filesystem::path& path,
                                    const std::vector<SettingChange>& changes) {
    ConfigFile file = path.empty() ? ConfigFile::empty() : ConfigFile::load(path);
    for (const SettingChange& change : changes) file.set(change.key, change.value);
    SystemSettings settings = read_system_settings(file);
    settings.file = path;
    return settings;
}

}  // namespace thimble
