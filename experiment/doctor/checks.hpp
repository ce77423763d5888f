// What gathered facts mean for a session, and what to do about it. Pure.
#pragma once

#include "experiment/doctor/facts.hpp"
#include "experiment/doctor/finding.hpp"

namespace thimble {

// The session itself.
Finding check_session(const SessionFacts& session);
Finding check_programs(const ProgramFacts& programs);
Finding check_ports(const PortFacts& ports);
Finding check_firewall(const FirewallFacts& firewall, const PortFacts& ports, bool several_machines);
Finding check_software(const ProgramFacts& programs);

// Time.
Finding check_realtime(const RealtimeFacts& realtime);
Finding check_timer(const TimerFacts& timer, const RealtimeFacts& realtime);
Finding check_governor(const ProcessorFacts& processors);
Finding check_clock_source(const ProcessorFacts& processors);
Finding check_kernel(const KernelFacts& kernel);
Finding check_clock(const ClockFacts& clock, bool several_machines);

// Devices.
Finding check_handle(const DeviceFacts& devices, const SessionFacts& session);
Finding check_fingertip(const DeviceFacts& devices, const SessionFacts& session);
Finding check_can(const CanFacts& can, const KernelFacts& kernel, const SessionFacts& session);
Finding check_screen(const ScreenFacts& screen, bool window_wanted);
Finding check_sound(const SoundFacts& sound);

// All of them, in the order in which they are best mended.
std::vector<Finding> examine(const Facts& facts);

}  // namespace thimble
