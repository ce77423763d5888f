#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sodium.h>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "common/text_file.hpp"
#include "master/devices/falcon/falcon_link.hpp"
#include "master/devices/falcon/falcon_packet.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

// Requests of the FTDI chip.
constexpr std::uint8_t kReset = 0, kModem = 1, kFlow = 2, kBaud = 3, kLine = 4, kLatency = 9;
constexpr std::uint16_t kPurgeReceived = 1, kPurgeUnsent = 2, kNoFlow = 0, kEightBits = 8;
constexpr std::uint16_t kRtsLow = 0x0200, kDtrLow = 0x0100, kDtrHigh = 0x0101;
constexpr std::uint16_t kBaud9600 = 0x4138, kBaud140k = 0x0015, kBaud1500k = 0x0002;

constexpr std::size_t kChunk = 62;  // with the two status bytes of its echo one USB packet
constexpr int kGreetings = 100, kLoads = 3, kKnocks = 10;
constexpr Duration kAnswer = milliseconds{20};

constexpr std::array<std::uint8_t, 3> kGreeting{0x0a, 0x43, 0x0d};
// A zero may come before it: with the chip's two status bytes a packet of 7 bytes instead of 6 (libnifalcon f7c727a).
constexpr std::array<std::uint8_t, 4> kGreeted{0x0a, 0x44, 0x2c, 0x0d};
constexpr std::array<std::uint8_t, 1> kBegin{0x41};

// As many bytes as asked, or as came before it fell silent.
std::vector<std::uint8_t> read_all(FalconLink& link, std::size_t count) {
    std::vector<std::uint8_t> bytes(count);
    std::size_t have = 0;
    while (have < count) {
        const std::size_t more = link.read(std::span(bytes).subspan(have), kAnswer);
        if (more == 0) break;
        have += more;
    }
    bytes.resize(have);
    return bytes;
}

bool purge(FalconLink& link) {
    return link.control(kReset, kPurgeReceived) && link.control(kReset, kPurgeUnsent);
}

bool set_loading(FalconLink& link) {
    return purge(link) && link.control(kLatency, 16) && link.control(kBaud, kBaud9600) &&
           link.control(kLine, kEightBits) && link.control(kFlow, kNoFlow) && link.control(kModem, kRtsLow) &&
           link.control(kModem, kDtrLow) && link.control(kModem, kDtrHigh);
}

// A purge drops the rest of an answer that was wrong: else it would begin the next one.
bool greet(FalconLink& link) {
    for (int i = 0; i < kGreetings && !link.lost(); ++i) {
        if (!link.control(kReset, kPurgeReceived) || !link.write(kGreeting)) return false;
        auto answer = read_all(link, kGreeted.size());
        if (!answer.empty() && answer.front() == 0) {
            answer.erase(answer.begin());
            const auto last = read_all(link, 1);
            answer.insert(answer.end(), last.begin(), last.end());
        }
        if (std::equal(answer.begin(), answer.end(), kGreeted.begin(), kGreeted.end())) return true;
    }
    return false;
}

bool echoes(FalconLink& link, std::span<const std::uint8_t> bytes) {
    if (!link.write(bytes)) return false;
    const auto echo = read_all(link, bytes.size());
    return std::equal(bytes.begin(), bytes.end(), echo.begin(), echo.end());
}

// Empty if the image is in the device; else the step that failed.
std::string try_to_load(FalconLink& link, std::span<const std::uint8_t> image) {
    if (!set_loading(link)) return "setting up its USB chip";
    if (!greet(link)) return "its boot loader's greeting";
    if (!link.control(kModem, kDtrLow) || !link.control(kBaud, kBaud140k) || !echoes(link, kBegin))
        return "the beginning of the upload";
    for (std::size_t sent = 0; sent < image.size(); sent += kChunk) {
        if (!echoes(link, image.subspan(sent, std::min(kChunk, image.size() - sent))))
            return fmt::format("the echo of byte {} of {}", sent, image.size());
    }
    if (!set_falcon_running(link)) return "setting up its USB chip again";
    return falcon_answers(link) ? "" : "the first report of the loaded firmware";
}

[[noreturn]] void fail_to_read(const std::string& path, const char* why) {
    throw Error(ExitCode::kUsage, "cannot read the Falcon's firmware '{}' ([handle.falcon] firmware): {}",
                path, why);
}

std::string bytes_of_firmware(const std::string& path) {
    constexpr std::size_t kMostBytes = 1 << 20;
    std::error_code unknown;
    if (std::filesystem::is_directory(path, unknown)) fail_to_read(path, "it is a folder; name a file");
    std::ifstream file(path, std::ios::binary);
    if (!file) fail_to_read(path, std::strerror(errno));
    std::string bytes = read_to_end(file, path, kMostBytes);
    if (bytes.empty()) fail_to_read(path, "it is empty");
    if (bytes.size() > kMostBytes) fail_to_read(path, "it is larger than 1 MiB; is it a Falcon firmware?");
    return bytes;
}

}  // namespace

bool set_falcon_running(FalconLink& link) {
    return link.control(kLatency, 1) && link.control(kBaud, kBaud1500k) && purge(link);
}

bool falcon_answers(FalconLink& link) {
    FalconReportReader reader;
    for (int i = 0; i < kKnocks && !link.lost(); ++i) {
        // A boot loader echoes the command, which looks like a report. So the lights alternate: only an echo follows
        // them.
        const FalconPacket command = encode(FalconCommand{{}, true, i % 2 == 0 ? kFalconRed : kFalconGreen});
        std::array<std::uint8_t, 64> bytes{};
        if (!link.write(command)) return false;
        const std::size_t count = link.read(bytes, kAnswer);
        const auto report = reader.take(std::span(bytes).first(count));
        if (report && encode(*report) != command) return true;
    }
    return false;
}

void load_falcon_firmware(FalconLink& link, std::span<const std::uint8_t> image) {
    std::string failed;
    for (int i = 0; i < kLoads && !link.lost(); ++i) {
        failed = try_to_load(link, image);
        if (failed.empty()) return;
    }
    throw Error(ExitCode::kRunFailed,
                "cannot load the Falcon's firmware: {} failed {} times ({}). Unplug the Falcon from power "
                "and USB, and plug both in again without a USB hub; is the file a Falcon firmware?",
                failed, kLoads, link.last_error());
}

std::vector<std::uint8_t> read_falcon_firmware(const std::string& path, const std::string& sha256) {
    const std::string bytes = bytes_of_firmware(path);
    std::vector<std::uint8_t> image(bytes.begin(), bytes.end());
    std::array<std::uint8_t, crypto_hash_sha256_BYTES> sum{};
    crypto_hash_sha256(sum.data(), image.data(), image.size());
    const std::string found = fmt::format("{:02x}", fmt::join(sum, ""));
    if (found != sha256) {
        throw Error(ExitCode::kUsage,
                    "the Falcon's firmware '{}' is not the expected one: its SHA-256 is {}, but "
                    "[handle.falcon] firmware_sha256 is {}",
                    path, found, sha256);
    }
    return image;
}

}  // namespace thimble
