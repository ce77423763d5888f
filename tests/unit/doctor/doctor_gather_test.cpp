// Facts from /proc, /sys and /etc, in folders made for the test, and from other programs' output.
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/text_file.hpp"
#include "tests/refusal.hpp"
#include "thimble/doctor/facts.hpp"

namespace thimble {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class MadeMachine : public testing::Test {
  protected:
    void write(const std::string& file, const std::string& text) const {
        std::filesystem::create_directories((root / file).parent_path());
        write_text(root / file, text);
    }
    void hidraw(const std::string& number, const std::string& id, const std::string& descriptor) const {
        const std::string folder = "sys/class/hidraw/hidraw" + number + "/device/";
        write(folder + "uevent", "DRIVER=hid-generic\nHID_ID=0003:" + id + "\nHID_NAME=Some Maker\n");
        write(folder + "report_descriptor", descriptor);
    }
    const TemporaryDirectory made;
    const std::filesystem::path root = made / "root";
};

// An application collection of one usage of a page of one byte, and nothing in it.
std::string collection(char page, char usage) {
    return {0x05, page, 0x09, usage, static_cast<char>(0xa1), 0x01, static_cast<char>(0xc0)};
}

TEST_F(MadeMachine, Processors) {
    write("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "powersave\n");
    write("sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "powersave\n");
    write("sys/devices/system/cpu/cpu2/cpufreq/scaling_governor", "performance\n");
    write("sys/devices/system/clocksource/clocksource0/current_clocksource", "hpet\n");
    write("sys/devices/system/clocksource/clocksource0/available_clocksource", "hpet acpi_pm \n");
    const ProcessorFacts facts = gather_processors(root);
    EXPECT_THAT(facts.governors, ElementsAre("powersave", "performance"));
    EXPECT_EQ(facts.clock_source, "hpet");
    EXPECT_THAT(facts.clock_sources, ElementsAre("hpet", "acpi_pm"));
    EXPECT_GE(facts.processors, 1U);
}

TEST_F(MadeMachine, WithNothingInItIsNoError) {
    EXPECT_THAT(gather_processors(root).governors, IsEmpty());
    EXPECT_FALSE(gather_kernel(root).can);
    EXPECT_THAT(gather_can(root).interfaces, IsEmpty());
    EXPECT_THAT(gather_devices(root).devices, IsEmpty());
    EXPECT_EQ(gather_firewall(root).kind, FirewallKind::kNone);
}

// A folder can be opened, but not read: as the governor of a processor that is switched off.
TEST_F(MadeMachine, WhatTheSystemFailsToReadIsNoError) {
    for (const char* file :
         {"sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "sys/class/net/can0/type",
          "sys/class/hidraw/hidraw0/device/uevent", "sys/bus/usb/devices/1-1/idVendor", "etc/ufw/ufw.conf"})
        std::filesystem::create_directories(root / file);
    write("sys/class/hidraw/hidraw1/device/uevent", "HID_ID=0003:0000256F:0000C635\n");
    std::filesystem::create_directories(root / "sys/class/hidraw/hidraw1/device/report_descriptor");
    EXPECT_THAT(gather_processors(root).governors, IsEmpty());
    EXPECT_THAT(gather_can(root).interfaces, IsEmpty());
    gather_devices(root);
    EXPECT_EQ(gather_firewall(root).kind, FirewallKind::kNone);
}

TEST_F(MadeMachine, CanInterfacesAreKnownByTheirType) {
    write("sys/class/net/eth0/type", "1\n");
    write("sys/class/net/can0/type", "280\n");
    write("sys/class/net/can0/operstate", "down\n");
    write("sys/class/net/can0/tx_queue_len", "10\n");
    write("sys/class/net/vcan0/type", "280\n");
    write("sys/class/net/vcan0/operstate", "unknown\n");
    const CanFacts facts = gather_can(root);
    ASSERT_EQ(facts.interfaces.size(), 2U);
    EXPECT_EQ(facts.interfaces[0].name, "can0");
    EXPECT_FALSE(facts.interfaces[0].up);
    EXPECT_EQ(facts.interfaces[0].queue_frames, 10);
    EXPECT_EQ(facts.interfaces[1].queue_frames, 0);
    EXPECT_TRUE(facts.interfaces[1].up);
}

TEST_F(MadeMachine, HidDevicesAreToldApart) {
    hidraw("0", "0000256F:0000C635", collection(1, 8));
    hidraw("1", "0000256F:0000C650", collection(1, 2));
    hidraw("2", "0000046D:0000C077", collection(1, 2));  // a mouse of the same maker
    hidraw("3", "00001209:00000001",
           {0x06, 0x54, static_cast<char>(0xff), 0x09, 0x01, static_cast<char>(0xa1), 0x01,
            static_cast<char>(0xc0)});
    hidraw("4", "0000054C:00000CE6", collection(1, 5));
    hidraw("5", "0000054C:00000CE6", "\x05");                                                  // cut short
    hidraw("6", "0000046D:0000C52B", collection(1, 6) + collection(1, 2) + collection(1, 8));  // a receiver
    write("dev/hidraw0", "");
    const auto devices = gather_devices(root).devices;
    ASSERT_EQ(devices.size(), 5U);
    EXPECT_EQ(devices[4].use, DeviceUse::kHidHand);
    EXPECT_EQ(devices[0].use, DeviceUse::kHidHand);
    EXPECT_EQ(devices[0].name, "SpaceMouse Compact (256f:c635)");
    EXPECT_EQ(devices[0].node, "/dev/hidraw0");
    EXPECT_TRUE(devices[0].accessible);
    EXPECT_EQ(devices[1].use, DeviceUse::kUnusable);
    EXPECT_FALSE(devices[1].accessible);
    EXPECT_EQ(devices[2].use, DeviceUse::kFingertipBoard);
    EXPECT_EQ(devices[3].use, DeviceUse::kHidHand);
    EXPECT_EQ(devices[3].name, "Some Maker (054c:0ce6)");
}

TEST_F(MadeMachine, UsbHandlesAndRules) {
    write("sys/bus/usb/devices/1-1/idVendor", "1451\n");
    write("sys/bus/usb/devices/1-1/idProduct", "0402\n");
    write("sys/bus/usb/devices/1-1/product", "omega.x haptic device\n");
    write("sys/bus/usb/devices/1-1/busnum", "1\n");
    write("sys/bus/usb/devices/1-1/devnum", "12\n");
    write("sys/bus/usb/devices/1-2/idVendor", "0403\n");
    write("sys/bus/usb/devices/1-2/idProduct", "cb48\n");
    write("etc/udev/rules.d/70-thimble-hid.rules", "");
    write("etc/udev/rules.d/99-other.rules", "");
    const DeviceFacts facts = gather_devices(root);
    ASSERT_EQ(facts.devices.size(), 2U);
    EXPECT_EQ(facts.devices[0].use, DeviceUse::kForceDimension);
    EXPECT_EQ(facts.devices[0].name, "omega.x haptic device (1451:0402)");
    EXPECT_EQ(facts.devices[0].node, "/dev/bus/usb/001/012");
    EXPECT_EQ(facts.devices[1].use, DeviceUse::kFalcon);
    EXPECT_THAT(facts.rules, ElementsAre("70-thimble-hid.rules"));
}

TEST_F(MadeMachine, FirewallsByTheirFiles) {
    write("etc/ufw/ufw.conf", "# comment\nENABLED=no\n");
    EXPECT_EQ(gather_firewall(root).kind, FirewallKind::kNone);
    write("run/firewalld/pid", "");
    EXPECT_EQ(gather_firewall(root).kind, FirewallKind::kFirewalld);
    write("etc/ufw/ufw.conf", "# comment\nENABLED=yes\n");
    EXPECT_EQ(gather_firewall(root).kind, FirewallKind::kUfw);
}

TEST(DoctorWords, TheChainThatDrops) {
    const std::string rules =
        "table ip nat {\n\tchain output {\n\t\ttype nat hook output priority 0; policy drop;\n\t}\n}\n"
        "table inet filter {\n\tchain input {\n\t\ttype filter hook input priority filter; policy ";
    EXPECT_EQ(dropping_chain(rules + "drop;\n\t}\n}\n"), "inet filter input");
    EXPECT_EQ(dropping_chain(rules + "accept;\n\t}\n}\n"), "");
    EXPECT_EQ(dropping_chain(""), "");
}

TEST(DoctorWords, SocketsOfAPort) {
    const std::string table =
        "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode "
        "ref\n"
        " 1090: 00000000:6978 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 12345 2 "
        "0 0\n"
        " 1091: 0100007F:6979 00000000:0000 07 00000000:00000000 00:00000000 00000000  1000        0 777 2 0 "
        "0\n";
    EXPECT_THAT(udp_inodes(table, 27000), ElementsAre("12345"));
    EXPECT_THAT(udp_inodes(table, 27001), ElementsAre("777"));
    EXPECT_THAT(udp_inodes(table, 27002), IsEmpty());
}

TEST(DoctorWords, AnIpv6SocketHoldsThePortOfIpv4) {
    const FileDescriptor taken(socket(AF_INET6, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    const int no = 0;
    sockaddr_in6 at{};
    socklen_t size = sizeof at;
    at.sin6_family = AF_INET6;
    auto* const address = static_cast<sockaddr*>(static_cast<void*>(&at));
    if (setsockopt(taken.get(), IPPROTO_IPV6, IPV6_V6ONLY, &no, sizeof no) != 0 ||
        bind(taken.get(), address, size) != 0 || getsockname(taken.get(), address, &size) != 0)
        GTEST_SKIP() << "needs IPv6";
    const PortFacts facts = gather_ports(ntohs(at.sin6_port), 1);
    ASSERT_FALSE(facts.taken.empty());
    EXPECT_EQ(facts.taken[0].process, getpid());
}

}  // namespace
}  // namespace thimble
