#include "session/settings/system_settings.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/runtime_settings.hpp"

namespace thimble {
namespace {

constexpr const char* kModalityHelp =
    "use HF (handle), CF (fingers of the acting hand), CCF (fingers of the other hand) or VF (bar on the "
    "screen)";

TrialOrder read_order(const ConfigTable& table) {
    const std::string name = table.text("order", to_string(TrialOrder::kShuffled));
    const auto order = parse_order(name);
    if (!order) table.fail("order", fmt::format("is \"{}\"; use shuffled or williams", name));
    return *order;
}

void read_subject(const ConfigTable& table, SessionPlan& plan) {
    if (!table.is_text("subject")) {
        plan.subject = static_cast<std::uint32_t>(table.integer("subject", 1, 1, 1'000'000));
        if (table.has("participant")) table.fail("participant", "is of subject = \"human\" only");
        return;
    }
    if (table.text("subject", "") != "human") table.fail("subject", "must be a number, or \"human\"");
    plan.kind = SubjectKind::kHuman;
    const std::string name = table.text("participant", "");
    const auto participant = parse_participant(name);
    if (!participant && table.has("participant")) {
        table.fail("participant",
                   fmt::format("is \"{}\"; use P and a number, e.g. \"P07\", never a name", name));
    }
    plan.subject = participant.value_or(0);
}

SessionPlan read_plan(const ConfigTable& table) {
    SessionPlan plan;
    std::vector<std::string> names;
    for (const Modality modality : plan.modalities) names.emplace_back(to_string(modality));
    plan.modalities.clear();
    for (const std::string& name : table.texts("modalities", names)) {
        const auto modality = find_modality(name);
        if (!modality) table.fail("modalities", fmt::format("holds \"{}\"; {}", name, kModalityHelp));
        plan.modalities.push_back(*modality);
    }
    if (plan.modalities.empty()) table.fail("modalities", "is empty; name at least one of HF, CF, CCF, VF");
    std::vector<double> delays;
    for (const Duration delay : plan.delays) delays.push_back(to_seconds(delay));
    plan.delays.clear();
    for (const double delay_s : table.numbers("delays_s", delays, 0, 60)) {
        plan.delays.push_back(from_seconds(delay_s));
    }
    if (plan.delays.empty()) table.fail("delays_s", "is empty; name at least one delay, e.g. [0.05]");
    plan.seed = static_cast<std::uint64_t>(table.integer("seed", 1, 0, INT64_MAX));
    read_subject(table, plan);
    plan.order = read_order(table);
    plan.fixture_jitter_m = table.number("fixture_jitter_m", plan.fixture_jitter_m, 0, 1);
    plan.parallel_conditions = static_cast<int>(table.integer("parallel_conditions", 0, 0, 64));
    return plan;
}

SessionSettings read_session(const ConfigFile& file) {
    using std::chrono::seconds;
    const ConfigTable trial = file.table("trial");
    SessionSettings s;
    s.trial_timeout = trial.seconds("timeout_s", s.trial_timeout, seconds{1}, seconds{3600});
    s.peer_wait = trial.seconds("peer_wait_s", s.peer_wait, std::chrono::milliseconds{100}, seconds{600});
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

const char* to_string(TrialOrder order) { return order == TrialOrder::kWilliams ? "williams" : "shuffled"; }

std::optional<TrialOrder> parse_order(std::string_view text) {
    for (const TrialOrder order : {TrialOrder::kShuffled, TrialOrder::kWilliams}) {
        if (text == to_string(order)) return order;
    }
    return std::nullopt;
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
    s.visual = read_visual_settings(file);
    s.instructions = read_instructions(file.table("instructions"));
    s.netem = read_netem_settings(file);
    s.session = read_session(file);
    s.session.contact_hold = s.slave.contact_hold;
    s.plan = read_plan(file.table("session"));
    const ConfigTable protocol = file.table("protocol");
    if (file.root().has("protocol")) s.protocol = read_protocol_settings(protocol);
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
