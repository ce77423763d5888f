#include "cutaneous_node/emulator/slcan_pty.hpp"

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <linux/tty.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <fmt/format.h>

#include "common/error.hpp"

namespace thimble {
namespace {

[[noreturn]] void no_adapter(const char* what) {
    throw Error(ExitCode::kNetwork,
                "cannot act as a CAN adapter: {}: {}; this needs root and 'modprobe slcan'", what,
                std::strerror(errno));
}

// "tIIILDD..": standard data frames, which is all that CANopen sends.
bool read_line(std::string_view line, CanFrame& frame) {
    if (line.size() < 5 || line[0] != 't') return false;
    const auto hexadecimal = [&](std::size_t at, std::size_t digits, std::uint32_t& value) {
        const char* const end = line.data() + at + digits;
        return at + digits <= line.size() && std::from_chars(line.data() + at, end, value, 16).ptr == end;
    };
    std::uint32_t length = 0, byte = 0;
    frame = {};
    if (!hexadecimal(1, 3, frame.id) || !hexadecimal(4, 1, length) || length > 8) return false;
    frame.length = static_cast<std::uint8_t>(length);
    for (std::size_t i = 0; i < length; ++i) {
        if (!hexadecimal(5 + 2 * i, 2, byte)) return false;
        frame.data[i] = static_cast<std::uint8_t>(byte);
    }
    return true;
}

}  // namespace

SlcanPty::SlcanPty(bool lies) : lies_(lies) {
    adapter_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (adapter_ < 0 || grantpt(adapter_) != 0 || unlockpt(adapter_) != 0) no_adapter("no pseudo-terminal");
    std::array<char, 64> name{};
    if (ptsname_r(adapter_, name.data(), name.size()) != 0) no_adapter("no pseudo-terminal");
    kernel_ = open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (kernel_ < 0) no_adapter(name.data());
    termios raw{};
    tcgetattr(kernel_, &raw);
    cfmakeraw(&raw);
    tcsetattr(kernel_, TCSANOW, &raw);
    const int discipline = N_SLCAN;
    if (ioctl(kernel_, TIOCSETD, &discipline) != 0) no_adapter("no slcan");
    std::array<char, IFNAMSIZ> interface {};
    if (ioctl(kernel_, SIOCGIFNAME, interface.data()) != 0) no_adapter("slcan without an interface");
    interface_ = interface.data();
}

SlcanPty::~SlcanPty() {
    close(kernel_);
    close(adapter_);
}

// Distorts a line: empty, too short, no digits, nine bytes, an unknown kind of frame, noise.
void SlcanPty::lie(std::string& line) {
    static constexpr std::array<const char*, 6> kNonsense{
        "\r", "t12\r", "tx8g8zz\r", "t1819112233445566778899\r", "q181\r", "\a\x01\xfe\r"};
    ++said_;
    if (said_ % kCutEvery == 0) line.resize(line.size() / 2);
    line.insert(0, kNonsense[said_ % kNonsense.size()]);
}

void SlcanPty::say(const std::string& line) {
    const auto written = write(adapter_, line.data(), line.size());
    ++(written == static_cast<ssize_t>(line.size()) ? counters_.sent : counters_.send_failed);
}

void SlcanPty::send(const CanFrame& frame) {
    switch (trouble_of(frame)) {
        case BusTrouble::kOff:
            return say("sb000000\r");
        case BusTrouble::kPassive:
            return say("sp128128\r");
        default:
            break;
    }
    std::string line = fmt::format("t{:03x}{}", frame.id & 0x7ffU, frame.length);
    for (std::size_t i = 0; i < frame.length; ++i) line += fmt::format("{:02x}", frame.data[i]);
    line += '\r';
    if (lies_) lie(line);
    say(line);
}

bool SlcanPty::receive(SessionTime /*now*/, CanFrame& frame) {
    for (;;) {
        const auto end = heard_.find('\r');
        if (end == std::string::npos) {
            std::array<char, 512> buffer{};
            const auto size = read(adapter_, buffer.data(), buffer.size());
            if (size <= 0) return false;
            heard_.append(buffer.data(), static_cast<std::size_t>(size));
            continue;
        }
        const std::string line = heard_.substr(0, end);
        heard_.erase(0, end + 1);
        if (!read_line(line, frame)) continue;  // its settings: bit rate, open, close
        ++counters_.received;
        return true;
    }
}

}  // namespace thimble
