// A gamepad made of uinput, and the vibration of thimble-visual on it: found by its name, played, changed, stopped, and gone. Ends
// with 0 if all of it is as it should be. Needs /dev/uinput and a devtmpfs: the kernel lane has both.
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <linux/uinput.h>
#include <mutex>
#include <poll.h>
#include <stdexcept>
#include <string>
#include <sys/ioctl.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "common/runtime/wall_clock.hpp"
#include "visual_node/gamepad/vibration.hpp"

namespace {

using namespace thimble;

constexpr const char* kPadName = "Thimble test pad";
constexpr std::uint16_t kVendor = 0x1209, kProduct = 0x7e57;

void check(bool good, const std::string& what) {
    if (!good) throw std::runtime_error(what + ": " + std::strerror(errno));
    std::printf("ok: %s\n", what.c_str());
}

// The last request to the owner of the device: of its effect, or stopped (both 0).
class UinputPad {
  public:
    UinputPad() : file_(::open("/dev/uinput", O_RDWR | O_CLOEXEC | O_NONBLOCK)) {
        check(file_ >= 0, "/dev/uinput opens");
        const bool bits =
            ::ioctl(file_, UI_SET_EVBIT, EV_KEY) == 0 && ::ioctl(file_, UI_SET_KEYBIT, BTN_SOUTH) == 0 &&
            ::ioctl(file_, UI_SET_EVBIT, EV_FF) == 0 && ::ioctl(file_, UI_SET_FFBIT, FF_RUMBLE) == 0;
        uinput_setup setup{};
        std::strncpy(setup.name, kPadName, sizeof setup.name - 1);
        setup.id = {BUS_USB, kVendor, kProduct, 1};
        setup.ff_effects_max = 4;
        check(bits && ::ioctl(file_, UI_DEV_SETUP, &setup) == 0 && ::ioctl(file_, UI_DEV_CREATE) == 0,
              "a gamepad is made");
        owner_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
    }
    ~UinputPad() { unplug(); }
    UinputPad(const UinputPad&) = delete;
    UinputPad& operator=(const UinputPad&) = delete;

    void unplug() {
        if (file_ < 0) return;
        owner_ = {};
        ::ioctl(file_, UI_DEV_DESTROY);
        ::close(file_);
        file_ = -1;
    }
    std::vector<RumbleLevels> played() {
        const std::lock_guard lock(mutex_);
        return played_;
    }
    // The last of them, once there are so many; some more are one too many, unless `more`.
    RumbleLevels wait_for(std::size_t count, bool more = false) {
        for (int i = 0; i < 500 && played().size() < count; ++i) wall_sleep(std::chrono::milliseconds{2});
        const auto all = played();
        if (all.size() < count || (all.size() > count && !more))
            throw std::runtime_error("played " + std::to_string(all.size()) + " times");
        return all.back();
    }

  private:
    void serve(const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            pollfd ready{file_, POLLIN, 0};
            if (::poll(&ready, 1, 10) <= 0) continue;
            input_event event{};
            while (::read(file_, &event, sizeof event) == static_cast<ssize_t>(sizeof event)) take(event);
        }
    }
    void take(const input_event& event) {
        if (event.type == EV_UINPUT && event.code == UI_FF_UPLOAD) {
            uinput_ff_upload upload{};
            upload.request_id = static_cast<std::uint32_t>(event.value);
            ::ioctl(file_, UI_BEGIN_FF_UPLOAD, &upload);
            effect_ = {upload.effect.u.rumble.strong_magnitude, upload.effect.u.rumble.weak_magnitude};
            upload.retval = 0;
            ::ioctl(file_, UI_END_FF_UPLOAD, &upload);
        } else if (event.type == EV_UINPUT && event.code == UI_FF_ERASE) {
            uinput_ff_erase erase{};
            erase.request_id = static_cast<std::uint32_t>(event.value);
            ::ioctl(file_, UI_BEGIN_FF_ERASE, &erase);
            erase.retval = 0;
            ::ioctl(file_, UI_END_FF_ERASE, &erase);
        } else if (event.type == EV_FF && event.code < 4) {
            const std::lock_guard lock(mutex_);
            played_.push_back(event.value > 0 ? effect_ : RumbleLevels{});
        }
    }

    int file_;
    std::mutex mutex_;
    RumbleLevels effect_;
    std::vector<RumbleLevels> played_;
    std::jthread owner_;
};

void follow_a_trial(UinputPad& pad, Vibration& vibration) {
    SessionTime now = wall_now();
    const auto feel = [&](double index_N, double thumb_N) {
        now += RumblePace::kPeriod;
        vibration.feel(now, index_N, thumb_N);
    };
    feel(0, 0);
    feel(2, 0);
    const RumbleLevels first = pad.wait_for(1);
    check(first.strong > 30'000 && first.strong < 45'000 && first.weak == 0, "2 N on the index finger");
    feel(4, 0);
    check(pad.wait_for(2) == RumbleLevels{65535, 0}, "4 N, the same effect with another strength");
    feel(0, 1);
    const RumbleLevels thumb = pad.wait_for(3);
    check(thumb.strong == 0 && thumb.weak > 20'000, "1 N on the thumb");
    feel(0, 0);
    check(pad.wait_for(4) == RumbleLevels{}, "no force, no vibration");
    feel(3, 0);
    pad.wait_for(5);
    vibration.stop();
    check(pad.wait_for(6) == RumbleLevels{}, "the end of a trial stops it at once");
    feel(3, 0);
    pad.wait_for(7);
}

void run() {
    UinputPad pad;
    const auto event = find_event_device("/sys/class/input", {kPadName, kVendor, kProduct});
    check(event.has_value(), "it is found by name and identity");
    check(!find_event_device("/sys/class/input", {kPadName, kVendor, 1}), "another one is not");
    {
        Vibration vibration("");
        vibration.plugged({kPadName, kVendor, kProduct});
        check(vibration.ready(), *event + " has motors");
        follow_a_trial(pad, vibration);
    }
    // Once by us, and once more by the kernel, which takes the effect away with the file.
    check(pad.wait_for(8, true) == RumbleLevels{}, "the end of the program stops it");
    Vibration vibration(*event);
    check(vibration.ready(), "a device that is named is used");
    pad.unplug();
    vibration.feel(wall_now(), 4, 0);
    check(!vibration.ready() && vibration.notice().find("is gone") != std::string::npos,
          "one that is pulled out is said to be gone: " + vibration.notice());
    vibration.plugged({});
    vibration.stop();
}

}  // namespace

int main() {
    try {
        run();
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "rumble: %s\n", error.what());
        return 1;
    }
}
