#include "experiment/remedies/remedy_study.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "experiment/link_test/verdict.hpp"
#include "experiment/metrics.hpp"
#include "experiment/protocol.hpp"
#include "experiment/study.hpp"
#include "experiment/virtual_session.hpp"

namespace thimble {
namespace {

// What no record holds: the hand itself.
struct HandSample {
    double time_s, position_hand_m, force_hand_N, position_needle_m;
};

struct Trial {
    TrialMetrics metrics;
    bool completed = false;
    double rendered_N_per_m = std::numeric_limits<double>::quiet_NaN();
    double drift_needle_m = std::numeric_limits<double>::quiet_NaN();
};

struct Job {
    std::size_t condition, row;
    TrialConditions conditions;
    double share;
};

// From the end of arriving to the beep, or to the end of a trial without one.
void measure_hand(const std::vector<HandSample>& samples, const TrialRecord& record, const SystemSettings& s,
                  Trial& trial) {
    const double from_s = trial.metrics.first_contact_time_s + kHoldSettling_s;
    const double surface_hand_m = record.conditions.fixture_position_m / s.master.position_scale;
    double force_N = 0, depth_m = 0, drift_m = 0, count = 0;
    for (const HandSample& sample : samples) {
        if (!(sample.time_s >= from_s) || sample.time_s > record.beep_time_s) continue;
        force_N += sample.force_hand_N;
        depth_m += sample.position_hand_m - surface_hand_m;
        drift_m += std::fabs(s.master.position_scale * sample.position_hand_m - sample.position_needle_m);
        ++count;
    }
    if (count == 0) return;
    trial.drift_needle_m = drift_m / count;
    if (depth_m > 0) trial.rendered_N_per_m = force_N / depth_m;
}

Trial run_trial(SystemSettings settings, const Job& job, const RemedyCondition& condition) {
    settings.master.control = condition.control;
    settings.master.control.share = job.share;
    settings.cutaneous.hand_share = settings.master.control.hand_share();
    settings.slave.wave = wave_end_of(settings.master.control, settings.slave.wave);
    set_delay(settings.netem.force, settings.netem.force_timeline, from_seconds(job.conditions.delay_s));
    VirtualSession session(settings);
    std::vector<HandSample> samples;
    session.session().set_sample_hook([&](const TrajectorySample& sample) {
        samples.push_back({sample.time_s, session.handle().position_hand_m(), session.handle().force_hand_N(),
                           sample.position_needle_m});
    });
    const TrialRecord& record = session.run(job.conditions);
    Trial trial;
    trial.metrics = measure(record);
    trial.completed = record.reason == EndReason::kCompleted && trial.metrics.beeped;
    measure_hand(samples, record, settings, trial);
    return trial;
}

// There and back, jitter included.
double longest_delay_s(SystemSettings settings, double force_delay_s) {
    set_delay(settings.netem.force, settings.netem.force_timeline, from_seconds(force_delay_s));
    return to_seconds(session_settings(settings).network_delay);
}

// Trials by whoever is free; each into its own place.
std::vector<Trial> run_jobs(const SystemSettings& settings, const std::vector<RemedyCondition>& conditions,
                            const std::vector<Job>& jobs, const RemedyStudyOptions& options) {
    std::vector<Trial> trials(jobs.size());
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure;
    std::mutex mutex;
    const auto work = [&] {
        for (std::size_t i = next++; i < jobs.size(); i = next++) {
            if (options.stop != nullptr && *options.stop) return;
            try {
                trials[i] = run_trial(settings, jobs[i], conditions[jobs[i].condition]);
            } catch (...) {
                const std::lock_guard lock(mutex);
                failure = std::current_exception();
                next = jobs.size();
            }
        }
    };
    std::vector<std::thread> threads;
    for (unsigned i = 1; i < thread_count(options.jobs); ++i) threads.emplace_back(work);
    work();
    for (std::thread& thread : threads) thread.join();
    if (failure) std::rethrow_exception(failure);
    return trials;
}

// A mean of those that exist.
class Mean {
  public:
    void add(double value) {
        if (!std::isfinite(value)) return;
        sum_ += value;
        ++count_;
    }
    double value() const { return count_ == 0 ? TrialMetrics::kNone : sum_ / count_; }

  private:
    double sum_ = 0, count_ = 0;
};

void fill(RemedyRow& row, const std::vector<Trial>& trials, double true_N_per_m) {
    Mean peak, mean, most, time, rendered, drift;
    for (const Trial& trial : trials) {
        ++row.trials;
        row.completed += trial.completed ? 1 : 0;
        row.oscillating += trial.metrics.oscillates ? 1 : 0;
        peak.add(trial.metrics.oscillation_peak_to_peak_m);
        mean.add(trial.metrics.penetration_mean_m);
        most.add(trial.metrics.penetration_max_m);
        time.add(trial.metrics.completion_time_s);
        rendered.add(trial.rendered_N_per_m / true_N_per_m);
        drift.add(trial.drift_needle_m);
    }
    row.oscillation_peak_to_peak_m = peak.value();
    row.penetration_mean_m = mean.value();
    row.penetration_max_m = most.value();
    row.completion_time_s = time.value();
    row.rendered_stiffness = rendered.value();
    row.drift_needle_m = drift.value();
}

std::vector<RemedyCondition> chosen(const SystemSettings& settings, const std::vector<std::string>& names) {
    std::vector<RemedyCondition> all = remedy_conditions(settings);
    if (names.empty()) return all;
    std::vector<std::string> known;
    known.reserve(all.size());
    for (const RemedyCondition& condition : all) known.push_back(condition.name);
    for (const std::string& name : names) {
        if (std::find(known.begin(), known.end(), name) == known.end())
            throw Error(ExitCode::kUsage,
                        fmt::format("'{}' is neither a modality nor a remedy: choose from {}", name,
                                    fmt::join(known, ", ")));
    }
    std::vector<RemedyCondition> some;
    for (const RemedyCondition& condition : all) {
        if (std::find(names.begin(), names.end(), condition.name) != names.end()) some.push_back(condition);
    }
    return some;
}

}  // namespace

std::vector<RemedyCondition> remedy_conditions(const SystemSettings& settings) {
    std::vector<RemedyCondition> conditions;
    conditions.reserve(kModalities.size() + kRemedyNames.size());
    for (const Modality modality : kModalities) conditions.push_back({to_string(modality), modality, {}});
    for (std::size_t i = 1; i < kRemedyNames.size(); ++i) {
        ControlSettings control;
        control.remedy = static_cast<Remedy>(i);
        if (settings.master.control.remedy == control.remedy) control = settings.master.control;
        conditions.push_back({std::string(kRemedyNames[i]), Modality::kHF, control});
    }
    return conditions;
}

double stable_share(const SystemSettings& settings, double delay_s, double margin) {
    const HeldHandle held = held_handle(settings);
    const double whole_N_per_m = settings.master.position_scale * settings.master.force_scale *
                                 fixture_stiffness_N_per_m(settings.slave);
    const double loop_s = delay_s + 0.5 * to_seconds(settings.master.sample_period);
    if (critical_delay_s(held, whole_N_per_m) > loop_s) return 1;
    double stable = 0, unstable = 1;
    for (int i = 0; i < 50; ++i) {
        const double share = 0.5 * (stable + unstable);
        (critical_delay_s(held, share * whole_N_per_m) > loop_s ? stable : unstable) = share;
    }
    return margin * stable;
}

std::vector<RemedyRow> run_remedy_study(const SystemSettings& settings, const RemedyStudyOptions& options) {
    const std::vector<RemedyCondition> conditions = chosen(settings, options.names);
    const Protocol protocol = experiment_3(settings, options.subjects, options.seed);
    std::vector<RemedyRow> rows;
    std::vector<Job> jobs;
    for (std::size_t c = 0; c < conditions.size(); ++c) {
        const bool scaled = conditions[c].control.remedy == Remedy::kScaled;
        for (const double delay_s : options.delays_s) {
            const double share = scaled ? stable_share(settings, longest_delay_s(settings, delay_s)) : 1;
            for (std::uint32_t subject = 1; subject <= options.subjects; ++subject) {
                for (std::uint32_t trial = 1; trial <= options.trials; ++trial)
                    jobs.push_back(
                        {c,
                         rows.size(),
                         {options.seed, protocol.experiment, subject, trial, conditions[c].modality, delay_s,
                          draw_fixture_position_m(protocol, subject, trial), false},
                         share});
            }
            RemedyRow row;
            row.name = conditions[c].name;
            row.delay_s = delay_s;
            row.share = share;
            rows.push_back(row);
        }
    }
    const std::vector<Trial> trials = run_jobs(settings, conditions, jobs, options);
    if (options.stop != nullptr && *options.stop) return {};
    const double true_N_per_m = settings.master.position_scale * settings.master.force_scale *
                                fixture_stiffness_N_per_m(settings.slave);
    const std::size_t each = jobs.size() / std::max<std::size_t>(rows.size(), 1);
    for (std::size_t r = 0; r < rows.size(); ++r) {
        const auto first = trials.begin() + static_cast<std::ptrdiff_t>(r * each);
        fill(rows[r], {first, first + static_cast<std::ptrdiff_t>(each)}, true_N_per_m);
    }
    return rows;
}

}  // namespace thimble
