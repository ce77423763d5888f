// The meaning of gathered facts for a session, and advice. Pure.
#pragma once

#include "thimble/doctor/diagnosis.hpp"
#include "thimble/doctor/facts.hpp"

namespace thimble {

// The session itself.
Diagnosis check_session(const SessionFacts& session);
Diagnosis check_programs(const ProgramFacts& programs);
Diagnosis check_ports(const PortFacts& ports);
Diagnosis check_firewall(const FirewallFacts& firewall, const PortFacts& ports, bool several_machines);
Diagnosis check_software(const ProgramFacts& programs);

// Time.
Diagnosis check_realtime(const RealtimeFacts& realtime);
Diagnosis check_timer(const TimerFacts& timer, const RealtimeFacts& realtime);
Diagnosis check_governor(const ProcessorFacts& processors);
Diagnosis check_clock_source(const ProcessorFacts& processors);
Diagnosis check_kernel(const KernelFacts& kernel);
Diagnosis check_clock(const ClockFacts& clock, bool several_machines);

// Devices.
Diagnosis check_handle(const DeviceFacts& devices, const SessionFacts& session);
Diagnosis check_fingertip(const DeviceFacts& devices, const SessionFacts& session);
Diagnosis check_can(const CanFacts& can, const KernelFacts& kernel, const SessionFacts& session);
Diagnosis check_screen(const ScreenFacts& screen, bool window_wanted);
Diagnosis check_sound(const SoundFacts& sound);

// All of them, in the order in which they are best mended.
std::vector<Diagnosis> examine(const Facts& facts);

}  // namespace thimble
