// A CAN bus in UDP datagrams, as cannelloni version 2 writes them (its doc/udp_format.md), big-endian:
//   u8 version = 2, u8 operation (0: data), u8 sequence, u16 frames; each: u32 identifier with flags, u8 length, data
// (none in a remote frame). Frames of CAN FD (bit 7 of the length) are refused: no drive here speaks it.
//
// A network may repeat datagrams and change their order. The sequence byte shows both, as far as 128 datagrams back. The bus
// ignores a repeated datagram. The frames of a late one get a smaller CanFrame::order than the frames before.
#pragma once

#include <optional>

#include "common/channel.hpp"
#include "common/security/sealing.hpp"
#include "cutaneous_node/can/can_bus.hpp"

namespace thimble {

inline constexpr std::size_t kCannelloniHeaderBytes = 5;
inline constexpr std::size_t kCannelloniFrameBytes = 5 + 8;  // at most
// As many as fit into a datagram of ours: twice what 1 Mbit/s carries in a millisecond.
inline constexpr std::size_t kCannelloniFrames =
    (kMaxDatagramBytes - kCannelloniHeaderBytes) / kCannelloniFrameBytes;

// How many frames a datagram holds; nothing if it is not exactly as written above.
std::optional<std::size_t> count_frames(Bytes datagram);
// The frame at `at`, which is moved behind it. `datagram` has been counted.
CanFrame take_frame(Bytes datagram, std::size_t& at);

class CannelloniBus final : public CanBus {
  public:
    // `channel` outlives the bus.
    explicit CannelloniBus(Channel& channel) : channel_(&channel) {}

    void send(const CanFrame& frame) override;
    void flush() override;
    bool receive(SessionTime now, CanFrame& frame) override;
    bool down() const override { return false; }  // the interface is another machine's

  private:
    bool next_datagram(SessionTime now);
    // False: this datagram has been here before.
    bool take_sequence(SessionTime arrived, std::uint8_t sequence);

    Channel* channel_;
    alignas(16) std::array<std::uint8_t, kMaxDatagramBytes> out_{};
    std::size_t out_bytes_ = kCannelloniHeaderBytes, out_frames_ = 0;
    std::uint8_t sequence_ = 0;
    Bytes in_;
    std::size_t in_at_ = 0, in_frames_ = 0;
    // Sequence bytes, counted on across each wrap.
    std::uint64_t in_order_ = 0, newest_ = 256;
    SessionTime newest_at_ = kNever;
    ReplayWindow seen_;
};

}  // namespace thimble
