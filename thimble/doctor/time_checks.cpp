#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "thimble/doctor/checks.hpp"

namespace thimble {
namespace {

// As kDeadlineSlack: a later wake-up has missed its sample.
constexpr double kMissed_s = 0.001;
// The kernel's timers without high resolution tick 100 to 1000 times a second.
constexpr double kCoarse_s = 0.0001;

double in_us(double seconds) { return 1e6 * seconds; }

// Read in hardware over a slow bus: a microsecond or more for each look at the clock.
bool is_slow_clock(const std::string& source) {
    constexpr std::array kSlowClocks{"hpet", "acpi_pm", "jiffies", "refined-jiffies"};
    return std::find(kSlowClocks.begin(), kSlowClocks.end(), source) != kSlowClocks.end();
}

}  // namespace

Diagnosis check_realtime(const Facts& facts) {
    const RealtimeFacts& realtime = facts.realtime;
    Diagnosis finding{"real time", ExitCode::kRealtime};
    if (!realtime.wanted)
        return finding.is(Severity::kOk, "not requested ([runtime] realtime_scheduling = false)");
    if (realtime.granted)
        return finding.is(Severity::kOk,
                          fmt::format("SCHED_FIFO, priority {}, is allowed", realtime.priority));
    finding.is(
        Severity::kWarning,
        fmt::format("this user may not use SCHED_FIFO, priority {}: other programs can delay the force loop",
                    realtime.priority),
        fmt::format("ulimit -r {}", realtime.priority));
    if (realtime.hard_limit < 0 || realtime.hard_limit >= realtime.priority) return finding;
    return finding.adds(
        Severity::kWarning, "; log in again to make it effective",
        fmt::format("echo \"$USER - rtprio {}\" | sudo tee /etc/security/limits.d/thimble.conf",
                    std::max(70, realtime.priority)));
}

Diagnosis check_timer(const Facts& facts) {
    const TimerFacts& timer = facts.timer;
    Diagnosis finding{"timer", ExitCode::kRealtime};
    if (timer.wake_ups == 0) return finding.is(Severity::kNote, "not measured");
    finding.values = {{"median_us", in_us(timer.median_s)},
                      {"p99_us", in_us(timer.p99_s)},
                      {"worst_us", in_us(timer.worst_s)},
                      {"wake_ups", static_cast<double>(timer.wake_ups)}};
    finding.says = fmt::format(
        "{} wake-ups, one each {} ms, late by {:.0f} us (median), {:.0f} us (99 %), {:.0f} us (worst)",
        timer.wake_ups, 1000 * timer.period_s, in_us(timer.median_s), in_us(timer.p99_s),
        in_us(timer.worst_s));
    if (timer.allowed_s <= kMissed_s) return finding;
    const std::string rights = check_realtime(facts).remedy;
    finding.adds(Severity::kWarning,
                 fmt::format("; more than {} % miss their sample", 100 * timer.allowed_miss_fraction),
                 rights.empty() ? "top -o %CPU   # then end other programs that use the processor" : rights);
    if (timer.median_s <= kMissed_s) return finding;
    return finding.adds(Severity::kFault, ", half of them: no force loop of 1 kHz can run here",
                        finding.remedy);
}

Diagnosis check_governor(const Facts& facts) {
    const ProcessorFacts& processors = facts.processors;
    Diagnosis finding{"processors", ExitCode::kRealtime};
    finding.values = {{"processors", static_cast<double>(processors.processors)}};
    finding.says =
        fmt::format("{} processors", processors.processors) +
        (processors.governors.empty() ? ", whose frequency the kernel cannot set"
                                      : fmt::format(", governor {}", fmt::join(processors.governors, ", ")));
    const auto slow = [](const std::string& governor) { return governor != "performance"; };
    if (std::any_of(processors.governors.begin(), processors.governors.end(), slow)) {
        return finding.adds(
            Severity::kWarning, ": they slow down between two samples and wake up late",
            "echo performance | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor");
    }
    if (processors.processors >= 2) return finding;
    return finding.adds(Severity::kWarning,
                        ": the programs of a session wait for each other; run some on another machine",
                        "thimble run deploy/sessions/three_machines.toml --check");
}

Diagnosis check_clock_source(const Facts& facts) {
    const ProcessorFacts& processors = facts.processors;
    Diagnosis finding{"clock source", ExitCode::kRealtime};
    finding.says = processors.clock_source.empty() ? "unknown" : processors.clock_source;
    if (!is_slow_clock(processors.clock_source)) return finding;
    finding.adds(Severity::kWarning, ": each reading of the clock takes a microsecond or more");
    const auto& sources = processors.clock_sources;
    const auto better = std::find_if_not(sources.begin(), sources.end(), is_slow_clock);
    if (better == sources.end()) return finding.adds(Severity::kWarning, "; this machine has no other");
    return finding.adds(
        Severity::kWarning, "",
        fmt::format("echo {} | sudo tee /sys/devices/system/clocksource/clocksource0/current_clocksource",
                    *better));
}

Diagnosis check_kernel(const Facts& facts) {
    const KernelFacts& kernel = facts.kernel;
    Diagnosis finding{"kernel", ExitCode::kRealtime};
    finding.says =
        fmt::format("{} ({}), timers of {:g} ns, CAN: {}, hidraw: {}", kernel.release, kernel.preemption,
                    1e9 * kernel.timer_resolution_s, kernel.can ? "yes" : "no", kernel.hidraw ? "yes" : "no");
    finding.values = {{"timer_resolution_us", in_us(kernel.timer_resolution_s)}};
    if (kernel.timer_resolution_s <= kCoarse_s) return finding;
    return finding.adds(Severity::kWarning,
                        "; without high-resolution timers (CONFIG_HIGH_RES_TIMERS) wake-ups come late",
                        "sudo apt-get install linux-image-amd64");
}

Diagnosis check_clock(const Facts& facts) {
    const ClockFacts& clock = facts.clock;
    Diagnosis finding{"clock", ExitCode::kRunFailed};
    if (clock.known && clock.synchronised) {
        finding.values = {{"error_bound_s", clock.error_bound_s}};
        return finding.is(Severity::kOk,
                          fmt::format("synchronised, within {:.1f} ms by the kernel's own bound; {}",
                                      1000 * clock.error_bound_s, clock.chrony));
    }
    finding.says =
        clock.known ? "not synchronised; " : "the kernel does not say whether it is synchronised; ";
    if (!facts.session.several_machines)
        return finding.adds(Severity::kOk, "enough for a session on one machine");
    return finding.adds(Severity::kOk, "Thimble measures the offsets between machines (docs/clocks.md)");
}

}  // namespace thimble
