#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "thimble/doctor/checks.hpp"

namespace thimble {
namespace {

// As kDeadlineSlack: what is later has missed its sample.
constexpr double kMissed_s = 0.001;
// The kernel's timers without high resolution tick 100 to 1000 times a second.
constexpr double kCoarse_s = 0.0001;
// Read in hardware over a slow bus: a microsecond or more for each look at the clock.
constexpr std::array kSlowClocks{"hpet", "acpi_pm", "jiffies", "refined-jiffies"};

double in_us(double seconds) { return 1e6 * seconds; }

template <class List>
bool holds(const List& list, const std::string& word) {
    return std::find(list.begin(), list.end(), word) != list.end();
}

}  // namespace

Diagnosis check_realtime(const RealtimeFacts& realtime) {
    Diagnosis finding{"real time", Severity::kOk, "", "", ExitCode::kRealtime};
    if (!realtime.wanted) {
        finding.says = "not asked for ([runtime] realtime_scheduling = false)";
        return finding;
    }
    if (realtime.granted) {
        finding.says = fmt::format("SCHED_FIFO, priority {}, is granted", realtime.priority);
        return finding;
    }
    finding.severity = Severity::kWarning;
    finding.says =
        fmt::format("this user may not have SCHED_FIFO, priority {}: deadlines depend on what else runs",
                    realtime.priority);
    if (realtime.hard_limit < 0 || realtime.hard_limit >= realtime.priority) {
        finding.remedy = fmt::format("ulimit -r {}", realtime.priority);
        return finding;
    }
    finding.says += "; the remedy holds from the next login on";
    finding.remedy = fmt::format("echo \"$USER - rtprio {}\" | sudo tee /etc/security/limits.d/thimble.conf",
                                 std::max(70, realtime.priority));
    return finding;
}

Diagnosis check_timer(const TimerFacts& timer, const RealtimeFacts& realtime) {
    Diagnosis finding{"timer", Severity::kOk, "", "", ExitCode::kRealtime};
    if (timer.wake_ups == 0) {
        finding.severity = Severity::kNote;
        finding.says = "not measured";
        return finding;
    }
    finding.values = {{"median_us", in_us(timer.median_s)},
                      {"p99_us", in_us(timer.p99_s)},
                      {"worst_us", in_us(timer.worst_s)},
                      {"wake_ups", static_cast<double>(timer.wake_ups)}};
    finding.says = fmt::format(
        "{} wake-ups, one each {} ms, late by {:.0f} us (median), {:.0f} us (99 %), "
        "{:.0f} us (worst)",
        timer.wake_ups, 1000 * timer.period_s, in_us(timer.median_s), in_us(timer.p99_s),
        in_us(timer.worst_s));
    if (timer.allowed_s <= kMissed_s) return finding;
    finding.severity = Severity::kWarning;
    finding.says += fmt::format("; more than {} % miss their sample", 100 * timer.allowed_miss_fraction);
    if (timer.median_s > kMissed_s) {
        finding.severity = Severity::kFault;
        finding.says += ", half of them: no force loop of 1 kHz can run here";
    }
    const Diagnosis rights = check_realtime(realtime);
    finding.remedy = rights.remedy.empty() ? "top -o %CPU   # and end what else computes" : rights.remedy;
    return finding;
}

Diagnosis check_governor(const ProcessorFacts& processors) {
    Diagnosis finding{"processors", Severity::kOk, "", "", ExitCode::kRealtime};
    finding.says = fmt::format("{} processors", processors.processors);
    finding.values = {{"processors", static_cast<double>(processors.processors)}};
    if (processors.governors.empty()) {
        finding.says += ", whose frequency is not the kernel's to choose";
    } else {
        finding.says += fmt::format(", governor {}", fmt::join(processors.governors, ", "));
    }
    const auto slow = [](const std::string& governor) { return governor != "performance"; };
    if (std::any_of(processors.governors.begin(), processors.governors.end(), slow)) {
        finding.severity = Severity::kWarning;
        finding.says += ": they slow down between two samples and wake up late";
        finding.remedy = "echo performance | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor";
    } else if (processors.processors < 2) {
        finding.severity = Severity::kWarning;
        finding.says += ": the nodes of a session wait for each other; put some on another machine";
        finding.remedy = "thimble up deploy/sessions/three_machines.toml --check";
    }
    return finding;
}

Diagnosis check_clock_source(const ProcessorFacts& processors) {
    Diagnosis finding{"clock source", Severity::kOk, "", "", ExitCode::kRealtime};
    finding.says = processors.clock_source.empty() ? "unknown" : processors.clock_source;
    if (!holds(kSlowClocks, processors.clock_source)) return finding;
    finding.severity = Severity::kWarning;
    finding.says += ": each look at the clock takes a microsecond or more";
    for (const std::string& better : processors.clock_sources) {
        if (holds(kSlowClocks, better)) continue;
        finding.remedy = fmt::format(
            "echo {} | sudo tee /sys/devices/system/clocksource/clocksource0/current_clocksource", better);
        return finding;
    }
    finding.says += "; there is no other here";
    return finding;
}

Diagnosis check_kernel(const KernelFacts& kernel) {
    Diagnosis finding{"kernel", Severity::kOk, "", "", ExitCode::kRealtime};
    finding.says =
        fmt::format("{} ({}), timers of {:g} ns, CAN: {}, hidraw: {}", kernel.release, kernel.preemption,
                    1e9 * kernel.timer_resolution_s, kernel.can ? "yes" : "no", kernel.hidraw ? "yes" : "no");
    finding.values = {{"timer_resolution_us", in_us(kernel.timer_resolution_s)}};
    if (kernel.timer_resolution_s > kCoarse_s) {
        finding.severity = Severity::kWarning;
        finding.says += "; without high-resolution timers (CONFIG_HIGH_RES_TIMERS) deadlines are rounded up";
        finding.remedy = "sudo apt-get install linux-image-amd64";
    }
    return finding;
}

Diagnosis check_clock(const ClockFacts& clock, bool several_machines) {
    Diagnosis finding{"clock", Severity::kOk, "", "", ExitCode::kRunFailed};
    if (clock.known && clock.synchronised) {
        finding.says = fmt::format("synchronised, within {:.1f} ms by the kernel's own bound; {}",
                                   1000 * clock.error_bound_s, clock.chrony);
        finding.values = {{"error_bound_s", clock.error_bound_s}};
        return finding;
    }
    finding.says =
        clock.known ? "not synchronised; " : "the kernel does not say whether it is synchronised; ";
    if (!several_machines) {
        finding.says += "a session on one machine needs nothing else";
        return finding;
    }
    finding.severity = Severity::kNote;
    finding.says += "offsets between the machines are measured, and bounded more widely than they could be";
    finding.remedy = "sudo apt-get install chrony";
    return finding;
}

}  // namespace thimble
