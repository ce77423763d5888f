// Each check with typical machines: its message, its severity, and the command that mends it.
#include <type_traits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "thimble/doctor/checks.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr auto kOk = Severity::kOk, kNote = Severity::kNote, kWarning = Severity::kWarning,
               kFault = Severity::kFault;

// Findings about a machine. An empty remedy: there is none.
struct MachineCase {
    Facts machine;
    Severity severity = kOk;
    const char *says = "", *remedy = "";
};

template <class Part>
Facts with(Part Facts::*member, std::type_identity_t<Part> value, Facts facts = {}) {
    facts.*member = std::move(value);
    return facts;
}

void expect_findings(Diagnosis (*check)(const Facts&), const std::vector<MachineCase>& cases) {
    for (const MachineCase& one : cases) {
        const Diagnosis finding = check(one.machine);
        SCOPED_TRACE(one.says + (" | " + finding.says));
        EXPECT_EQ(finding.severity, one.severity);
        EXPECT_THAT(finding.says, HasSubstr(one.says));
        EXPECT_THAT(finding.remedy, HasSubstr(one.remedy));
        EXPECT_EQ(finding.remedy.empty(), *one.remedy == '\0') << finding.remedy;
    }
}

SessionFacts session_with(const char* handle, const char* fingertip = "simulated") {
    return {"", "", false, handle, fingertip};
}

const SessionFacts kSeveral{"", "", true};

TEST(DoctorChecks, ABadSessionFileIsAFaultWithItsOwnWords) {
    const auto session = [](const char* problem) { return with(&Facts::session, {"my s/a.toml", problem}); };
    expect_findings(check_session,
                    {{{}, kOk, "default session"},
                     {session(""), kOk, "my s/a.toml is good"},
                     {session("a.toml:3: unknown"), kFault, "a.toml:3", "thimble check 'my s/a.toml'"}});
}

TEST(DoctorChecks, AKeyThatCannotBeUsedIsAFaultWithItsOwnRemedy) {
    const ProtectionFacts none{"lab-key", "cannot read the lab key", ExitCode::kUsage, "thimble keygen 'a'"};
    expect_findings(check_protection,
                    {{{}, kOk, "[security] mode = \"user-key\""},
                     {with(&Facts::protection, none), kFault, "cannot read", "thimble keygen 'a'"}});
}

TEST(DoctorChecks, AnEnergyLimitThatStopsTheTrialsIsAWarning) {
    SessionFacts session{"mine.toml", ""};
    session.energy = "write energy_limit_J = 2 into [guard]";
    expect_findings(check_session, {{with(&Facts::session, session), kWarning, "energy_limit_J = 2"}});
}

TEST(DoctorChecks, ProgramsMustBeThereAndOfOneVersion) {
    const auto netem = [](const char* version) {
        return with(&Facts::programs,
                    {"0.1.0", "bin", {{"thimble-master", "0.1.0"}, {"thimble-netem", version}}, "", ""});
    };
    expect_findings(
        check_programs,
        {{netem("0.1.0"), kOk, "thimble 0.1.0 and its 2 nodes"},
         {netem("0.0.9"), kFault, "thimble-netem 0.0.9 and thimble 0.1.0 differ", "cmake --build"},
         {netem(""), kFault, "no thimble-netem that runs in bin", "cmake --build"}});
    expect_findings(check_software,
                    {{with(&Facts::programs, {"", "", {}, "gnuplot 5.4", "Debian"}), kOk, "Debian, gnuplot"},
                     {{}, kWarning, "would have no figures", "gnuplot-nox"}});
}

TEST(DoctorChecks, PythonsPackageIsOfTheSameVersion) {
    const auto python = [](const char* version) {
        return with(&Facts::programs, {"0.1.0", "", {}, "", "", version});
    };
    expect_findings(check_python,
                    {{python("0.1.0"), kOk, "python3 imports thimble 0.1.0"},
                     {python(""), kNote, "cannot import thimble", "python3-thimble"},
                     {python("0.0.9"), kWarning, "thimble 0.0.9, but this is thimble 0.1.0", "__file__"}});
}

TEST(DoctorChecks, OurOwnProgramsAreEndedAtAPortOthersAreAvoided) {
    const auto taken = [](std::vector<TakenPort> by) {
        return with(&Facts::ports, {27000, 50, std::move(by), true});
    };
    const TakenPort ours{27003, 4711, "thimble-visual"}, also_ours{27009, 4711, "thimble-visual"};
    expect_findings(
        check_ports,
        {{taken({}), kOk, "27000 to 27049 are free"},
         {taken({ours, also_ours}), kFault, "27003 (by thimble-visual, process 4711) and others",
          "kill 4711"},
         {taken({ours, also_ours, {27010, 12, "jackd"}}), kFault, "3 of the UDP ports", "--base-port 27050"},
         {taken({{27001, 0, ""}}), kFault, "another user's program", "--base-port 27050"},
         {with(&Facts::ports, {27000, 25, {}, false}), kFault, "did not arrive", "ip link set lo up"}});
}

TEST(DoctorChecks, AFirewallMattersToSeveralMachinesOnly) {
    const Facts one = with(&Facts::ports, {27000, 25, {}, true});
    const Facts several = with(&Facts::session, kSeveral, one);
    expect_findings(
        check_firewall,
        {{several, kOk, "none found"},
         {with(&Facts::firewall, {FirewallKind::kUfw, ""}, one), kOk, "ufw is active"},
         {with(&Facts::firewall, {FirewallKind::kUfw, ""}, several), kWarning, "other machines",
          "sudo ufw allow 27000:27024/udp"},
         {with(&Facts::firewall, {FirewallKind::kFirewalld, ""}, several), kWarning, "firewalld",
          "--add-port=27000-27024/udp"},
         {with(&Facts::firewall, {FirewallKind::kNftables, "inet filter input"}, several), kWarning,
          "inet filter input", "nft insert rule inet filter input udp dport 27000-27024 accept"}});
}

TEST(DoctorChecks, ALimitOfPrioritiesThatCanBeRaisedIsToldFromOneThatCannot) {
    const auto realtime = [](RealtimeFacts facts) { return with(&Facts::realtime, facts); };
    expect_findings(check_realtime,
                    {{{}, kOk, "priority 60, is allowed"},
                     {realtime({false, true, 60, 0}), kOk, "not requested"},
                     {realtime({true, false, 60, 0}), kWarning, "may not use SCHED_FIFO", "rtprio 70"},
                     {realtime({true, false, 60, 95}), kWarning, "", "ulimit -r 60"},
                     {realtime({true, false, 60, -1}), kWarning, "", "ulimit -r 60"}});
}

TEST(DoctorChecks, ATimerIsJudgedByTheSamplesItMisses) {
    const auto late = [](double median_s, double allowed_s, bool granted = true) {
        return with(&Facts::timer, {0.001, 1000, median_s, 200e-6, allowed_s, 0.004, 0.001},
                    with(&Facts::realtime, {true, granted, 60, 0}));
    };
    expect_findings(check_timer, {{late(30e-6, 900e-6), kOk, "late by 30 us (median), 200 us (99 %)"},
                                  {late(30e-6, 0.002), kWarning, "more than 0.1 % miss", "top"},
                                  {late(30e-6, 0.002, false), kWarning, "", "rtprio 70"},
                                  {late(0.0015, 0.002), kFault, "half of them", "top"},
                                  {{}, kNote, "not measured"}});
}

TEST(DoctorChecks, SlowProcessorsAndClocksAreTold) {
    const auto machine = [](ProcessorFacts facts) { return with(&Facts::processors, std::move(facts)); };
    expect_findings(check_governor, {{machine({4, {}, "tsc", {}}), kOk, "the kernel cannot set"},
                                     {machine({4, {"performance"}, "tsc", {}}), kOk, "governor performance"},
                                     {machine({4, {"performance", "powersave"}, "tsc", {}}), kWarning,
                                      "performance, powersave", "echo performance"},
                                     {machine({1, {}, "tsc", {}}), kWarning, "1 processors", "thimble run"}});
    expect_findings(check_clock_source,
                    {{machine({2, {}, "tsc", {"tsc", "hpet"}}), kOk, "tsc"},
                     {machine({2, {}, "hpet", {"hpet", "acpi_pm", "tsc"}}), kWarning, "hpet", "echo tsc |"},
                     {machine({2, {}, "acpi_pm", {"acpi_pm"}}), kWarning, "no other"}});
    expect_findings(check_kernel, {{with(&Facts::kernel, {"6.1", "PREEMPT_DYNAMIC", 1e-9, true, false}), kOk,
                                    "timers of 1 ns, CAN: yes, hidraw: no"},
                                   {with(&Facts::kernel, {"6.1", "no PREEMPT", 0.004, true, true}), kWarning,
                                    "CONFIG_HIGH_RES_TIMERS", "linux-image"}});
}

TEST(DoctorChecks, NobodyNeedsASynchronisedClock) {
    const auto clock = [](ClockFacts facts) {
        return with(&Facts::clock, std::move(facts), with(&Facts::session, kSeveral));
    };
    expect_findings(check_clock,
                    {{clock({true, true, 0.002, "chrony follows x"}), kOk, "within 2.0 ms"},
                     {with(&Facts::clock, {true, false, 0, ""}), kOk, "enough for a session on one machine"},
                     {clock({true, false, 0, ""}), kOk, "measures the offsets between machines"},
                     {clock({false, false, 0, ""}), kOk, "does not say"}});
}

TEST(DoctorChecks, ADeviceThatIsWantedMustBeThereAndOpen) {
    const auto cap = [](bool open) {
        return DeviceFacts::Device{DeviceUse::kHidHand, "SpaceMouse Compact (256f:c635)", "/dev/hidraw3",
                                   open};
    };
    const auto plugged = [](const SessionFacts& session, DeviceFacts devices) {
        return with(&Facts::devices, std::move(devices), with(&Facts::session, session));
    };
    const DeviceFacts mouse{{{DeviceUse::kUnusable, "CadMouse (256f:c650)", "/dev/hidraw0", true}}, {}};
    const DeviceFacts board{{{DeviceUse::kFingertipBoard, "Board (1209:0001)", "/dev/hidraw1", true}}, {}};
    const SessionFacts hid = session_with("hid"), none;
    const std::vector<std::string> rules{"70-thimble-hid.rules"};
    expect_findings(
        check_handle,
        {{plugged(hid, {{cap(false)}, {}}), kFault,
          "this user may not open SpaceMouse Compact (256f:c635) at /dev/hidraw3", "deploy/udev/70-thimble"},
         {plugged(none, {{cap(false)}, {}}), kNote, "this user may not open", "deploy/udev/70-thimble"},
         {plugged(hid, {{cap(false)}, rules}), kFault, "log in at this machine", "udevadm trigger"},
         {plugged(hid, {{cap(true)}, rules}), kOk, "SpaceMouse Compact"},
         // One that is asked for and open is enough, whatever else is plugged in.
         {plugged(hid, {{cap(false), cap(true)}, {}}), kOk, "SpaceMouse"},
         {{}, kOk, "plugged in: none"},
         {plugged(session_with("falcon"), {}), kFault, "not plugged in", "lsusb"},
         {plugged(none, mouse), kOk, "cannot move the needle"},
         {plugged(hid, mouse), kFault, "not plugged in", "lsusb"},
         {plugged(none, board), kOk, "plugged in: none"}});
    expect_findings(check_fingertip,
                    {{plugged(session_with("simulated", "board"), board), kOk, "Board"},
                     {plugged(session_with("simulated", "board"), {}), kFault, "not plugged in", "lsusb"}});
    SessionFacts touchdiver = session_with("simulated", "touchdiver");
    expect_findings(check_fingertip, {{plugged(touchdiver, {}), kOk, "touchdiver"}});
    touchdiver.middleware_problem = "nobody listens at TCP pc:13031";
    expect_findings(check_fingertip, {{plugged(touchdiver, {}), kFault, "pc:13031: start WEART's", "ss"}});
}

TEST(DoctorChecks, CanIsNeededByDrivesOnly) {
    const Facts able = with(&Facts::kernel, {"", "", 1e-9, true});
    SessionFacts session = session_with("simulated", "drives");  // their bus is reached over UDP
    const Facts over_udp = with(&Facts::session, session, able);
    session.can_bus = "can0";
    const Facts drives = with(&Facts::session, session, able), no_can = with(&Facts::session, session);
    expect_findings(
        check_can, {{{}, kNote, "this kernel has no CAN", "modprobe can_raw"},
                    {able, kNote, "no interface", "type vcan"},
                    {over_udp, kNote, "no interface", "type vcan"},
                    {no_can, kFault, "this kernel has no CAN", "modprobe can_raw"},
                    {with(&Facts::can, {{{"can1", true, 100}}}, drives), kFault, "there is no interface can0",
                     "ip -br link"},
                    {with(&Facts::can, {{{"can0", false, 10}, {"can1", true, 100}}}, drives), kFault,
                     "can0 is down", "ip link set can0 up type can bitrate 1000000"},
                    {with(&Facts::can, {{{"can0", false, 10}, {"can1", true, 10}}}, able), kOk, "can1 is up"},
                    {with(&Facts::can, {{{"can0", true, 10}}}, drives), kWarning, "its queue holds 10 frames",
                     "ip link set can0 txqueuelen 100"},
                    {with(&Facts::can, {{{"can0", true, 100}}}, drives), kOk, "can0 is up"}});
}

TEST(DoctorChecks, AScreenIsAFaultOnlyWhereAWindowIsWanted) {
    const auto screen = [](ScreenFacts facts, bool window) {
        return with(&Facts::screen, std::move(facts), with(&Facts::session, {"", "", false, "", "", window}));
    };
    const ScreenFacts none{true, "no screen: DISPLAY is not set", "", ""};
    expect_findings(
        check_screen,
        {{screen(none, false), kNote, "no screen", "DISPLAY"},
         {screen(none, true), kFault, "no screen", "DISPLAY"},
         {screen({true, "no window with OpenGL 3.3", "", ""}, true), kFault, "OpenGL 3.3", "libgl1-mesa-dri"},
         {screen({false, "", "", ""}, false), kNote, "THIMBLE_GUI", "cmake"},
         {screen({true, "", "Mesa Intel", "OpenGL 4.6"}, true), kOk, "Mesa Intel"},
         {screen({true, "", "llvmpipe (LLVM 15)", "OpenGL 4.5"}, true), kWarning, "in software", "glxinfo"}});
    expect_findings(check_sound, {{{}, kOk, "beep"},
                                  {with(&Facts::sound, {true, "no device"}), kNote, "no device", "aplay"},
                                  {with(&Facts::sound, {false, ""}), kNote, "THIMBLE_GUI"}});
}

TEST(DoctorChecks, APersonNeedsSoundScreenAndTheHandlesSoftware) {
    SessionFacts person;
    person.human = true;
    const auto with_sound = [&](SoundFacts sound) {
        return with(&Facts::sound, std::move(sound), with(&Facts::session, person));
    };
    SessionFacts sees = person;
    sees.beep_shown = true;
    expect_findings(check_sound, {{with_sound({true, ""}), kOk, "beep"},
                                  {with_sound({true, "no device"}), kFault, "a person must hear it", "aplay"},
                                  {with_sound({false, ""}), kFault, "THIMBLE_AUDIO", "aplay"},
                                  {with(&Facts::sound, {true, "no device"}, with(&Facts::session, sees)),
                                   kNote, "shown", "aplay"}});
    const Facts blind = with(&Facts::screen, {true, "no screen", "", ""}, with(&Facts::session, person));
    expect_findings(check_screen, {{blind, kFault, "no screen", "DISPLAY"}});
    expect_findings(check_handle, {{with(&Facts::session, person), kWarning, "for a person set device"}});
    SessionFacts device = person;
    device.handle = "falcon";
    device.software_problem = "nvent.bin cannot be read";
    device.cutaneous_drawn = false;
    const Facts broken = with(&Facts::session, device);
    SessionFacts haply, touch;
    haply.handle = "haply";
    haply.software_problem = "no Haply Inverse Service";
    touch.handle = "touch";
    touch.software_problem = "no library";
    expect_findings(
        check_device_software,
        {{{}, kOk, "have all the SDKs"},
         {broken, kFault, "nvent.bin", "sha256sum"},
         {with(&Facts::session, haply), kFault, "no Haply", "systemctl status haply-inverse-service"},
         {with(&Facts::session, touch), kFault, "no library", "ldconfig -p | grep libHD"}});
    expect_findings(check_fingertip, {{broken, kWarning, "fingertip = true"}});
    EXPECT_FALSE(can_run(examine_for_person(broken)));
    EXPECT_EQ(exit_code(examine_for_person(with_sound({true, "no device"}))), ExitCode::kUsage);
}

TEST(DoctorChecks, Ros2NeedsADomainAndAnInterfaceThatMulticasts) {
    const Ros2Facts good{true, {{"127.0.0.1", "lo", true, true}}, "7", "", "rmw_fastrtps_cpp"};
    const auto but = [&good](auto change) {
        Ros2Facts facts = good;
        change(facts);
        return with(&Facts::ros2, facts);
    };
    expect_findings(
        check_ros2,
        {{but([](auto&) {}), kOk,
          "domain 7, by ROS_DOMAIN_ID; RMW_IMPLEMENTATION is rmw_fastrtps_cpp; lo at"},
         {but([](auto& f) { f.domain = ""; }), kOk, "ROS_DOMAIN_ID is not set"},
         {but([](auto& f) { f.domain_problem = "'x' is not a number"; }), kFault, "'x'",
          "unset ROS_DOMAIN_ID"},
         {but([](auto& f) { f.interfaces[0].name = ""; }), kFault, "has 127.0.0.1", "ip -4 address"},
         {but([](auto& f) { f.interfaces[0].up = false; }), kFault, "is down", "set lo up"},
         {but([](auto& f) { f.interfaces[0].multicast = false; }), kFault, "has no multicast",
          "multicast on"},
         {but([](auto& f) { f.wanted = f.interfaces[0].multicast = false; }), kNote, "has no multicast",
          "multicast on"},
         {but([](auto& f) { f.rmw = "rmw_zenoh_cpp"; }), kWarning, "does not use DDS", "export RMW"}});
}

TEST(DoctorChecks, ExitCodesAreThoseOfTheManual) {
    EXPECT_EQ(check_session({}).code, ExitCode::kUsage);
    SessionFacts fails{"mine.toml", "a plug-in crashed"};
    fails.problem_code = ExitCode::kRunFailed;
    EXPECT_EQ(check_session(with(&Facts::session, fails)).code, ExitCode::kRunFailed);
    const ProtectionFacts damaged{"lab-key", "holds no lab key", ExitCode::kData};
    EXPECT_EQ(check_protection(with(&Facts::protection, damaged)).code, ExitCode::kData);
    EXPECT_EQ(check_ports({}).code, ExitCode::kNetwork);
    EXPECT_EQ(check_timer({}).code, ExitCode::kRealtime);
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
    const auto written = to_json(findings);
    EXPECT_EQ(written["can_run"], true);
    ASSERT_EQ(written["findings"].size(), findings.size());
    std::size_t values = 0;
    for (std::size_t i = 0; i < findings.size(); ++i) {
        const auto& entry = written["findings"][i];
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
