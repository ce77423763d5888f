// Tests the Falcon's driver over a real kernel's USB, with an emulated device plugged into vhci_hcd. The device is absent,
// found, forbidden, loaded, and read and pushed for two seconds. Then its master and its guardian are killed and stopped,
// and it is unplugged. The test prints each difference and ends with exit code 1. It runs in the kernel lane, as root.
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sodium.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/wall_clock.hpp"
#include "master/devices/falcon/falcon_guardian.hpp"
#include "master/devices/falcon/falcon_handle.hpp"
#include "tests/kernel/vhci_falcon.hpp"

namespace {

using namespace thimble;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double kLimit_N = 8;
constexpr std::size_t kImageBytes = 8000;
const RuntimeSettings kPlain{false};  // the emulated device has no processor of its own
int complaints = 0;

void expect(bool good, const std::string& what) {
    fmt::print("{} {}\n", good ? "ok  " : "FAIL", what);
    std::fflush(stdout);
    if (!good) ++complaints;
}

std::string refusal(const FalconSettings& settings) {
    try {
        open_falcon(settings, kLimit_N, kPlain);
    } catch (const Error& error) {
        return error.what();
    }
    return "opened";
}

bool comes(const std::function<bool()>& condition, Duration limit) {
    for (const SessionTime end = wall_now() + limit; wall_now() < end; wall_sleep(milliseconds{1})) {
        if (condition()) return true;
    }
    return false;
}

// libusb without udevd sees only what was there when it began.
bool kernel_has_it() {
    return comes(
        [] {
            std::error_code none;
            for (const auto& entry : std::filesystem::directory_iterator("/sys/bus/usb/devices", none)) {
                std::string product;
                std::ifstream(entry.path() / "idProduct") >> product;
                if (product == "cb48" && std::filesystem::exists(entry.path() / "bConfigurationValue"))
                    return true;
            }
            return false;
        },
        seconds{10});
}

FalconSettings with_firmware() {
    std::vector<std::uint8_t> image(kImageBytes);
    for (std::size_t i = 0; i < image.size(); ++i) image[i] = static_cast<std::uint8_t>(i * 7);
    FalconSettings settings;
    settings.firmware = (std::filesystem::temp_directory_path() / "falcon.bin").string();
    std::ofstream(settings.firmware, std::ios::binary)
        .write(reinterpret_cast<const char*>(image.data()), static_cast<std::streamsize>(image.size()));
    std::array<std::uint8_t, crypto_hash_sha256_BYTES> sum{};
    crypto_hash_sha256(sum.data(), image.data(), image.size());
    for (const std::uint8_t byte : sum) settings.firmware_sha256 += fmt::format("{:02x}", byte);
    return settings;
}

// Another user, before any rule of udev.
void forbidden_to_nobody() {
    const pid_t child = fork();
    if (child == 0) {
        const bool other = setgid(65534) == 0 && setuid(65534) == 0;
        const std::string words = refusal({});
        fmt::print("     nobody is told: {}\n", words);
        std::fflush(stdout);
        _exit(other && words.find("this user may not open") != std::string::npos ? 0 : 1);
    }
    int status = -1;
    waitpid(child, &status, 0);
    expect(status == 0, "forbidden to another user");
}

// 1 kHz for two seconds, as the master does it; how many exchanges there were, per second.
void read_and_push(Handle& handle, VhciFalcon& falcon) {
    const auto exchanges = [&] {
        return falcon.with([](FalconEmulator& device) { return device.commands; });
    };
    handle.enable_force(wall_now(), true);
    const auto before = exchanges();
    const SessionTime begin = wall_now();
    int good = 0;
    for (int i = 0; i < 2000; ++i) {
        wall_sleep(begin + milliseconds{i} - wall_now());
        good += handle.read(wall_now()).valid ? 1 : 0;
        handle.command_force(wall_now(), 1);
    }
    const double rate_Hz = static_cast<double>(exchanges() - before) / to_seconds(wall_now() - begin);
    expect(good == 2000, fmt::format("{} of 2000 reads are valid", good));
    expect(rate_Hz > 400, fmt::format("{:.0f} exchanges per second", rate_Hz));
    const auto motors = falcon.with([](FalconEmulator& device) { return device.commanded.motors; });
    expect(motors[0] < -200,
           fmt::format("the motors push outwards: {} {} {}", motors[0], motors[1], motors[2]));
}

bool pushes(VhciFalcon& falcon) {
    return falcon.with([](FalconEmulator& device) { return device.commanded.motors[0] != 0; });
}

void push(FalconGuardian& guardian) {
    guardian.mailbox().take_withheld();
    guardian.mailbox().command({500, 0, 0});
}

// A master with a force at the handle, in a process of its own.
[[noreturn]] void push_for_ever() {
    FalconGuardian guardian({}, kPlain, "/proc/self/exe");
    for (;; wall_sleep(milliseconds{1})) push(guardian);
}

void lose_the_master(VhciFalcon& falcon, int number) {
    const pid_t master = fork();
    if (master == 0) push_for_ever();
    expect(comes([&] { return pushes(falcon); }, seconds{5}), "another process pushes");
    const SessionTime lost = wall_now();
    kill(master, number);
    const bool gone = comes([&] { return !pushes(falcon); }, seconds{1});
    const Duration after = wall_now() - lost;
    expect(gone && after < milliseconds{100},
           fmt::format("master gets signal {}: no force after {:.1f} ms", number, 1000 * to_seconds(after)));
    kill(master, SIGKILL);
    waitpid(master, nullptr, 0);
    wall_sleep(milliseconds{200});  // its guardian ends
}

void lose_the_guardian(VhciFalcon& falcon, int number) {
    FalconGuardian guardian({}, kPlain, "/proc/self/exe");
    expect(comes([&] { return push(guardian), pushes(falcon); }, seconds{5}), "a guardian pushes");
    const SessionTime lost = wall_now();
    kill(guardian.pid(), number);
    const bool gone = comes([&] { return push(guardian), !pushes(falcon); }, seconds{2});
    const Duration after = wall_now() - lost;
    expect(gone && after < milliseconds{400}, fmt::format("guardian gets signal {}: no force after {:.1f} ms",
                                                          number, 1000 * to_seconds(after)));
}

void unplug_in_trial(Handle& handle, VhciFalcon& falcon) {
    const SessionTime unplugged = wall_now();
    falcon.unplug();
    const bool noticed = comes([&] { return !handle.read(wall_now()).valid; }, seconds{1});
    const Duration after = wall_now() - unplugged;
    expect(noticed && after < milliseconds{50},
           fmt::format("noticed after {:.1f} ms: {}", 1000 * to_seconds(after), handle.fault()));
    expect(handle.fault().find("unplugged") != std::string_view::npos, "and named");
}

void run() {
    expect(refusal({}).find("there is no Novint Falcon on the USB") != std::string::npos,
           "absent: " + refusal({}));
    VhciFalcon falcon(0);
    falcon.with([](FalconEmulator& device) {
        device.image_bytes = kImageBytes;
        device.put_hand_at({0, 0, 0.115});
    });
    expect(kernel_has_it(), "the kernel has found it");
    forbidden_to_nobody();
    expect(refusal({}).find("has lost its firmware") != std::string::npos, "unloaded: " + refusal({}));
    auto handle = open_falcon(with_firmware(), kLimit_N, kPlain);
    expect(falcon.with([](FalconEmulator& device) { return device.running; }), "firmware loaded");
    expect(comes([&] { return handle->fault().empty(); }, seconds{1}), "and homed");
    expect(refusal({}).find("another program uses it") != std::string::npos, "busy: " + refusal({}));
    read_and_push(*handle, falcon);
    handle.reset();
    for (const int number : {SIGKILL, SIGSTOP}) {
        lose_the_master(falcon, number);
        lose_the_guardian(falcon, number);
    }
    handle = open_falcon({}, kLimit_N, kPlain);
    expect(comes([&] { return handle->fault().empty(); }, seconds{1}), "and is there again");
    handle->enable_force(wall_now(), true);
    unplug_in_trial(*handle, falcon);
}

}  // namespace

int main(int argc, char** argv) {
    if (const auto guarded = run_falcon_guardian(argc, argv)) return *guarded;
    try {
        run();
    } catch (const std::exception& error) {
        expect(false, error.what());
    }
    return complaints == 0 ? 0 : 1;
}
