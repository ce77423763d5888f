#include "session/virtual/energy_demand.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/process/isolated.hpp"
#include "session/records/condition_summary.hpp"
#include "session/settings/protocol.hpp"
#include "session/virtual/virtual_session.hpp"

namespace thimble {
namespace {

constexpr std::uint32_t kAskedSubjects = 3;
// An oscillation has shown its energy long before. Without a limit it may last for the whole trial.
constexpr Duration kLongestTrial = std::chrono::seconds{10};
// A person's hand is another one than that of the virtual subjects.
constexpr double kMargin = 2;

SystemSettings without_limit(SystemSettings settings) {
    settings.handle.kind = HandleKind::kSimulated;
    settings.master.guard.energy_limit_J = 0;
    settings.session.trial_timeout = std::min(settings.session.trial_timeout, kLongestTrial);
    return settings;
}

double given_out_in_trial_J(const SystemSettings& settings, const TrialConditions& conditions) {
    VirtualSession session(settings);
    session.run(conditions);
    return session.master().guard().most_given_out_J();
}

// A plug-in may crash or hang: in a copy of this process it ends the copy only.
double given_out_apart_J(const SystemSettings& settings, const TrialConditions& conditions) {
    const IsolatedResult apart =
        run_isolated([&] { return bytes_of(given_out_in_trial_J(settings, conditions)); });
    if (!apart.bytes) throw Error(ExitCode::kRunFailed, apart.failure);
    std::string_view bytes = *apart.bytes;
    return take_plain<double>(bytes);
}

// Rounded up to a tenth.
double needed_J(double most_J) { return std::ceil(10 * kMargin * most_J) / 10; }

}  // namespace

double most_given_out_J(const SystemSettings& settings, Duration delay, std::uint32_t subjects) {
    const SystemSettings free = with_force_delay(without_limit(settings), delay);
    const Protocol protocol = experiment_3(free, subjects, free.plan.seed);
    const bool plugin = settings.master.control.compensator == Compensator::kPlugin;
    double most_J = 0;
    for (std::uint32_t subject = 1; subject <= subjects; ++subject) {
        TrialConditions conditions;
        conditions.study_seed = protocol.seed;
        conditions.subject = subject;
        conditions.delay_s = to_seconds(delay);
        conditions.fixture_position_m = draw_fixture_position_m(protocol, subject, conditions.trial);
        most_J = std::max(
            most_J, plugin ? given_out_apart_J(free, conditions) : given_out_in_trial_J(free, conditions));
    }
    return most_J;
}

std::string energy_warning(const SystemSettings& settings, const std::vector<Duration>& delays) {
    const GuardSettings& guard = settings.master.guard;
    if (!is_real(settings.handle.kind) || guard.energy_limit_J <= 0) return {};
    double most_J = 0;
    Duration worst{};
    for (const Duration delay : delays) {
        const double given_out_J = most_given_out_J(settings, delay, kAskedSubjects);
        if (given_out_J > most_J) worst = delay;
        most_J = std::max(most_J, given_out_J);
    }
    if (needed_J(most_J) <= guard.energy_limit_J) return {};
    return fmt::format(
        "HF with a delay of {} gives the hand up to {:.2g} J within {:g} s in virtual time, but [guard] "
        "energy_limit_J is {:g}: the guard {} end such trials as safety stops. If the hand should feel this, "
        "write energy_limit_J = {:.1f} into [guard] (docs/safety.md explains why)",
        delay_text(to_seconds(worst)), most_J, to_seconds(guard.energy_window), guard.energy_limit_J,
        most_J > guard.energy_limit_J ? "will" : "may", needed_J(most_J));
}

std::string energy_warning(const SystemSettings& settings) {
    const std::vector<Modality>& modalities = settings.plan.modalities;
    const bool feels = std::find(modalities.begin(), modalities.end(), Modality::kHF) != modalities.end();
    return feels ? energy_warning(settings, settings.plan.delays) : std::string{};
}

}  // namespace thimble
