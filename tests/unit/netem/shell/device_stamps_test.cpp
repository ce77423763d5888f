// The stamps of a device, in a file of memory that stands for the ring of a packet socket.
#include "netem/shell/device_stamps.hpp"

#include <array>
#include <cstring>
#include <linux/if_packet.h>
#include <sys/mman.h>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>

#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

constexpr std::size_t kRingBytes = std::size_t{16} << 16, kEntryBytes = 256;

// Writes entries as the kernel does: the number is the packet.
class Ring {
  public:
    Ring() : file_(memfd_create("ring", MFD_CLOEXEC)) { EXPECT_EQ(ftruncate(file_, kRingBytes), 0); }
    ~Ring() { close(file_); }
    Ring(const Ring&) = delete;
    Ring& operator=(const Ring&) = delete;

    int file() const { return file_; }
    void note(std::uint8_t number) {
        tpacket2_hdr header{};
        header.tp_status = TP_STATUS_USER;
        header.tp_len = header.tp_snaplen = 1;
        header.tp_mac = sizeof header;
        std::vector<std::uint8_t> bytes(kEntryBytes);
        std::memcpy(bytes.data(), &header, sizeof header);
        bytes[sizeof header] = number;
        EXPECT_EQ(pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(written_++ * kEntryBytes)),
                  std::ssize(bytes));
    }

  private:
    int file_;
    std::size_t written_ = 0;
};

TEST(DeviceStamps, FindsThePacketBehindAnyNumberOfDroppedOnes) {
    for (const auto dropped : std::to_array<std::uint8_t>({0, 1, 63, 64, 65, 200})) {
        Ring ring;
        DeviceStamps stamps(ring.file());
        for (std::uint8_t number = 0; number <= dropped; ++number) ring.note(number);
        stamps.of(std::vector{dropped}, wall_now());
        EXPECT_EQ(stamps.missing(), 0U) << int{dropped};
    }
}

TEST(DeviceStamps, KeepsTheEntriesOfLaterPacketsForThem) {
    Ring ring;
    DeviceStamps stamps(ring.file());
    ring.note(1);
    stamps.of(std::vector<std::uint8_t>{2}, wall_now());
    EXPECT_EQ(stamps.missing(), 1U);
    stamps.of(std::vector<std::uint8_t>{1}, wall_now());
    EXPECT_EQ(stamps.missing(), 1U);
}

}  // namespace
}  // namespace thimble
