// Each check with typical machines: its message, its severity, and the command that mends it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "thimble/doctor/checks.hpp"
#include "thimble/doctor/doctor_report.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

void expect_finding(const Diagnosis& finding, Severity severity, const std::string& words,
                    const std::string& remedy) {
    EXPECT_EQ(finding.severity, severity) << finding.says;
    EXPECT_THAT(finding.says, HasSubstr(words));
    if (remedy.empty()) {
        EXPECT_THAT(finding.remedy, IsEmpty());
    } else {
        EXPECT_THAT(finding.remedy, HasSubstr(remedy));
    }
}

TEST(DoctorSession, ABadFileIsAFaultWithItsOwnWords) {
    expect_finding(check_session({}), Severity::kOk, "default session", "");
    SessionFacts bad;
    bad.file = "mine.toml";
    bad.problem = "mine.toml:3: unknown key";
    expect_finding(check_session(bad), Severity::kFault, "mine.toml:3", "thimble check mine.toml");
    EXPECT_EQ(check_session(bad).code, ExitCode::kUsage);
}

TEST(DoctorPrograms, MustBeThereAndOfOneVersion) {
    ProgramFacts programs{"0.1.0", "bin", {{"thimble-master", "0.1.0"}, {"thimble-netem", "0.1.0"}}, "", ""};
    expect_finding(check_programs(programs), Severity::kOk, "thimble 0.1.0 and its 2 nodes", "");
    programs.nodes[1].version = "0.0.9";
    expect_finding(check_programs(programs), Severity::kFault, "thimble-netem 0.0.9 beside thimble 0.1.0",
                   "cmake --build");
    programs.nodes[1].version = "";
    expect_finding(check_programs(programs), Severity::kFault, "no thimble-netem that runs in bin",
                   "cmake --build");
}

TEST(DoctorPorts, OurOwnProgramsAreEndedOthersAreAvoided) {
    PortFacts ports{27000, 50, 25, {}, true};
    expect_finding(check_ports(ports), Severity::kOk, "27000 to 27049 are free", "");
    ports.taken = {{27003, 4711, "thimble-visual"}, {27009, 4711, "thimble-visual"}};
    expect_finding(check_ports(ports), Severity::kFault, "27003 (by thimble-visual, process 4711) and others",
                   "kill 4711");
    ports.taken.push_back({27010, 12, "jackd"});
    expect_finding(check_ports(ports), Severity::kFault, "3 of UDP ports", "--base-port 27050");
    ports.taken = {{27001, 0, ""}};
    expect_finding(check_ports(ports), Severity::kFault, "another user's program", "--base-port 27050");
    EXPECT_EQ(check_ports(ports).code, ExitCode::kNetwork);
}

TEST(DoctorPorts, ALoopbackThatPassesNothingIsAFault) {
    expect_finding(check_ports({27000, 25, 25, {}, false}), Severity::kFault, "did not arrive",
                   "ip link set lo up");
}

TEST(DoctorFirewall, MattersToSeveralMachinesOnly) {
    const PortFacts ports{27000, 25, 25, {}, true};
    expect_finding(check_firewall({}, ports, true), Severity::kOk, "none was seen", "");
    expect_finding(check_firewall({FirewallKind::kUfw, ""}, ports, false), Severity::kOk, "ufw is active",
                   "");
    expect_finding(check_firewall({FirewallKind::kUfw, ""}, ports, true), Severity::kWarning,
                   "other machines", "sudo ufw allow 27000:27024/udp");
    expect_finding(check_firewall({FirewallKind::kFirewalld, ""}, ports, true), Severity::kWarning,
                   "firewalld", "--add-port=27000-27024/udp");
    expect_finding(check_firewall({FirewallKind::kNftables, "inet filter input"}, ports, true),
                   Severity::kWarning, "inet filter input",
                   "nft insert rule inet filter input udp dport 27000-27024 accept");
}

TEST(DoctorRealtime, TellsALimitThatCanBeRaisedFromOneThatCannot) {
    expect_finding(check_realtime({}), Severity::kOk, "priority 60, is granted", "");
    expect_finding(check_realtime({false, true, 60, 0}), Severity::kOk, "not asked for", "");
    expect_finding(check_realtime({true, false, 60, 0}), Severity::kWarning, "may not have SCHED_FIFO",
                   "rtprio 70");
    expect_finding(check_realtime({true, false, 60, 95}), Severity::kWarning, "", "ulimit -r 60");
    expect_finding(check_realtime({true, false, 60, -1}), Severity::kWarning, "", "ulimit -r 60");
}

TEST(DoctorTimer, IsJudgedByTheSamplesItMisses) {
    TimerFacts timer{0.001, 1000, 30e-6, 200e-6, 900e-6, 0.004, 0.001};
    expect_finding(check_timer(timer, {}), Severity::kOk, "late by 30 us (median), 200 us (99 %)", "");
    timer.allowed_s = 0.002;
    expect_finding(check_timer(timer, {}), Severity::kWarning, "more than 0.1 % miss", "top");
    expect_finding(check_timer(timer, {true, false, 60, 0}), Severity::kWarning, "", "rtprio 70");
    timer.median_s = 0.0015;
    expect_finding(check_timer(timer, {}), Severity::kFault, "half of them", "top");
    EXPECT_EQ(check_timer(timer, {}).code, ExitCode::kRealtime);
    expect_finding(check_timer({}, {}), Severity::kNote, "not measured", "");
}

TEST(DoctorGovernor, OneSlowProcessorIsEnough) {
    expect_finding(check_governor({4, {}, "tsc", {}}), Severity::kOk, "not the kernel's to choose", "");
    expect_finding(check_governor({4, {"performance"}, "tsc", {}}), Severity::kOk, "governor performance",
                   "");
    expect_finding(check_governor({4, {"performance", "powersave"}, "tsc", {}}), Severity::kWarning,
                   "performance, powersave", "echo performance");
    expect_finding(check_governor({1, {}, "tsc", {}}), Severity::kWarning, "1 processors", "thimble up");
}

TEST(DoctorClockSource, ASlowOneIsReplacedByOneThatIsThere) {
    expect_finding(check_clock_source({2, {}, "tsc", {"tsc", "hpet"}}), Severity::kOk, "tsc", "");
    expect_finding(check_clock_source({2, {}, "hpet", {"hpet", "acpi_pm", "tsc"}}), Severity::kWarning,
                   "hpet", "echo tsc |");
    expect_finding(check_clock_source({2, {}, "acpi_pm", {"acpi_pm"}}), Severity::kWarning, "no other", "");
}

TEST(DoctorKernel, WithoutHighResolutionTimersDeadlinesAreRounded) {
    expect_finding(check_kernel({"6.1", "PREEMPT_DYNAMIC", 1e-9, true, false}), Severity::kOk,
                   "timers of 1 ns, CAN: yes, hidraw: no", "");
    expect_finding(check_kernel({"6.1", "no PREEMPT", 0.004, true, true}), Severity::kWarning,
                   "CONFIG_HIGH_RES_TIMERS", "linux-image");
}

TEST(DoctorClock, NobodyNeedsItOnOneMachine) {
    expect_finding(check_clock({true, true, 0.002, "chrony follows x"}, true), Severity::kOk, "within 2.0 ms",
                   "");
    expect_finding(check_clock({true, false, 0, ""}, false), Severity::kOk, "needs nothing else", "");
    expect_finding(check_clock({true, false, 0, ""}, true), Severity::kNote, "bounded more widely", "chrony");
    expect_finding(check_clock({false, false, 0, ""}, true), Severity::kNote, "does not say", "chrony");
}

const DeviceFacts::Device kClosedCap{DeviceUse::kHidHand, "SpaceMouse Compact (256f:c635)", "/dev/hidraw3",
                                     false};

SessionFacts session_with(const std::string& handle, const std::string& fingertip = "simulated") {
    SessionFacts session;
    session.handle = handle;
    session.fingertip = fingertip;
    return session;
}

TEST(DoctorHandle, AClosedDeviceIsAFaultWhereItIsWanted) {
    DeviceFacts devices{{kClosedCap}, {}};
    expect_finding(check_handle(devices, session_with("hid")), Severity::kFault,
                   "SpaceMouse Compact (256f:c635) at /dev/hidraw3 may not be opened",
                   "deploy/udev/70-thimble");
    expect_finding(check_handle(devices, session_with("simulated")), Severity::kNote, "may not be opened",
                   "deploy/udev/70-thimble");
    devices.rules = {"70-thimble-hid.rules"};
    expect_finding(check_handle(devices, session_with("hid")), Severity::kFault, "log in at this machine",
                   "udevadm trigger");
    devices.devices[0].accessible = true;
    expect_finding(check_handle(devices, session_with("hid")), Severity::kOk, "SpaceMouse Compact", "");
}

TEST(DoctorHandle, AnAbsentOrWrongDeviceIsTold) {
    expect_finding(check_handle({}, session_with("simulated")), Severity::kOk, "plugged in: none", "");
    expect_finding(check_handle({}, session_with("falcon")), Severity::kFault, "not plugged in", "lsusb");
    const DeviceFacts mouse{{{DeviceUse::kUnusable, "CadMouse (256f:c650)", "/dev/hidraw0", true}}, {}};
    expect_finding(check_handle(mouse, session_with("simulated")), Severity::kOk, "no hand's input", "");
    expect_finding(check_handle(mouse, session_with("hid")), Severity::kFault, "not plugged in", "lsusb");
    // One that is asked for and open is enough, whatever else is plugged in.
    DeviceFacts two{{kClosedCap, kClosedCap}, {}};
    two.devices[1].accessible = true;
    expect_finding(check_handle(two, session_with("hid")), Severity::kOk, "SpaceMouse", "");
}

TEST(DoctorFingertip, ABoardIsNoHandle) {
    const DeviceFacts board{{{DeviceUse::kFingertipBoard, "Board (1209:0001)", "/dev/hidraw1", true}}, {}};
    expect_finding(check_handle(board, session_with("simulated")), Severity::kOk, "plugged in: none", "");
    expect_finding(check_fingertip(board, session_with("simulated", "board")), Severity::kOk, "Board", "");
    expect_finding(check_fingertip({}, session_with("simulated", "board")), Severity::kFault,
                   "not plugged in", "lsusb");
}

TEST(DoctorCan, IsNeededByDrivesOnly) {
    KernelFacts kernel;
    expect_finding(check_can({}, kernel, {}), Severity::kNote, "this kernel has none", "modprobe can_raw");
    kernel.can = true;
    expect_finding(check_can({}, kernel, {}), Severity::kNote, "no interface", "type vcan");
    expect_finding(check_can({{{"can0", false, 10}}}, kernel, session_with("simulated", "drives")),
                   Severity::kWarning, "can0 is down", "ip link set can0 up type can bitrate 1000000");
    expect_finding(check_can({{{"can0", false, 10}, {"can1", true, 10}}}, kernel, {}), Severity::kOk,
                   "can1 is up", "");
    expect_finding(check_can({{{"can0", true, 10}}}, kernel, session_with("simulated", "drives")),
                   Severity::kWarning, "10 frames may wait there", "ip link set can0 txqueuelen 100");
    expect_finding(check_can({{{"can0", true, 100}}}, kernel, session_with("simulated", "drives")),
                   Severity::kOk, "can0 is up", "");
}

TEST(DoctorScreen, IsAFaultOnlyWhereAWindowIsWanted) {
    const ScreenFacts none{true, "no screen: DISPLAY is not set", "", ""};
    expect_finding(check_screen(none, false), Severity::kNote, "no screen", "DISPLAY");
    expect_finding(check_screen(none, true), Severity::kFault, "no screen", "DISPLAY");
    expect_finding(check_screen({true, "no window with OpenGL 3.3", "", ""}, true), Severity::kFault,
                   "OpenGL 3.3", "libgl1-mesa-dri");
    expect_finding(check_screen({false, "", "", ""}, false), Severity::kNote, "THIMBLE_GUI", "cmake");
    expect_finding(check_screen({true, "", "Mesa Intel", "OpenGL 4.6"}, true), Severity::kOk, "Mesa Intel",
                   "");
    expect_finding(check_screen({true, "", "llvmpipe (LLVM 15)", "OpenGL 4.5"}, true), Severity::kWarning,
                   "in software", "glxinfo");
}

TEST(DoctorSound, IsNeverAFault) {
    expect_finding(check_sound({true, ""}), Severity::kOk, "beep", "");
    expect_finding(check_sound({true, "no device"}), Severity::kNote, "no device", "aplay");
    expect_finding(check_sound({false, ""}), Severity::kNote, "THIMBLE_GUI", "");
}

TEST(DoctorSoftware, ReportsNeedGnuplot) {
    expect_finding(check_software({"0.1.0", "", {}, "gnuplot 5.4", "Debian"}), Severity::kOk,
                   "Debian, gnuplot", "");
    expect_finding(check_software({"0.1.0", "", {}, "", ""}), Severity::kWarning, "without figures",
                   "gnuplot-nox");
}

Facts healthy() {
    Facts facts;
    facts.programs = {"0.1.0", "bin", {{"thimble-master", "0.1.0"}}, "gnuplot 5.4", "Debian"};
    facts.ports.count = 25;
    facts.timer.wake_ups = 1000;
    facts.processors.processors = 4;
    return facts;
}

TEST(DoctorReport, TheFirstFaultDecides) {
    Facts facts = healthy();
    auto findings = examine(facts);
    EXPECT_TRUE(can_run(findings)) << to_text(findings);
    EXPECT_EQ(exit_code(findings), ExitCode::kOk);
    EXPECT_THAT(to_text(findings), HasSubstr("A session can run here."));
    facts.timer.median_s = facts.timer.allowed_s = 0.01;
    facts.ports.taken = {{27000, 0, ""}};
    findings = examine(facts);
    EXPECT_EQ(exit_code(findings), ExitCode::kNetwork);
    EXPECT_THAT(to_text(findings), HasSubstr("cannot run here: ports"));
}

TEST(DoctorReport, JsonHasWhatTheTextHas) {
    Facts facts = healthy();
    facts.realtime.granted = false;
    const auto findings = examine(facts);
    const auto json = to_json(findings);
    EXPECT_EQ(json["can_run"], true);
    ASSERT_EQ(json["findings"].size(), findings.size());
    std::size_t values = 0;
    for (std::size_t i = 0; i < findings.size(); ++i) {
        const auto& entry = json["findings"][i];
        EXPECT_EQ(entry["name"], findings[i].name);
        EXPECT_EQ(entry["severity"], to_string(findings[i].severity));
        EXPECT_EQ(entry["remedy"], findings[i].remedy);
        EXPECT_THAT(to_text(findings), HasSubstr(findings[i].says));
        if (findings[i].severity == Severity::kWarning) {
            EXPECT_THAT(findings[i].remedy, Not(IsEmpty()));
        }
        for (const auto& [name, value] : findings[i].values) EXPECT_EQ(entry[name], value);
        values += findings[i].values.size();
    }
    EXPECT_GT(values, 0U);
}

}  // namespace
}  // namespace thimble
