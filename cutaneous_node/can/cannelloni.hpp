// A CAN bus in UDP datagrams, as cannelloni version 2 writes them (its doc/udp_format.md), big-endian:
//   u8 version = 2, u8 operation (0: data), u8 sequence, u16 frames; each: u32 identifier with flags, u8 length, data
// (none in a remote frame). Frames of CAN FD (bit 7 of the length) are refused: no drive here speaks it.
//
// A network may repeat datagrams and change their order. The sequence byte shows both, as far as 128 datagrams back. The bus
// ignores a repeated datagram. The frames of a late one get a smaller CanFrame::order than the frames before.
#pragma once

#include <algorithm>
#include <optional>

#include "common/channel.hpp"
#include "common/security/sealing.hpp"
#include "cutaneous_node/can/can_bus.hpp"

namespace thimble {

inline constexpr std::uint8_t kCannelloniVersion = 2;

inline constexpr std::uint8_t kCannelloniData = 0;

inline constexpr std::uint8_t kMostAhead = 127;

// A gateway that has said nothing new for so long may have been started anew, and counts from 0 again.
inline constexpr Duration kSequenceForgotten = std::chrono::milliseconds{100};

inline bool is_remote(Bytes datagram, std::size_t at) { return (datagram[at] & (kCanRemote >> 24U)) != 0; }

inline constexpr std::size_t kCannelloniHeaderBytes = 5;
inline constexpr std::size_t kCannelloniFrameBytes = 5 + 8;  // at most
// As many as fit into a datagram of ours: twice what 1 Mbit/s carries in a millisecond.
inline constexpr std::size_t kCannelloniFrames =
    (kMaxDatagramBytes - kCannelloniHeaderBytes) / kCannelloniFrameBytes;

// How many frames a datagram holds; nothing if it is not exactly as written above.
inline std::optional<std::size_t> count_frames(Bytes datagram) {
    if (datagram.size() < kCannelloniHeaderBytes) return std::nullopt;
    if (datagram[0] != kCannelloniVersion || datagram[1] != kCannelloniData) return std::nullopt;
    const std::size_t frames = std::size_t{datagram[3]} << 8U | datagram[4];
    std::size_t at = kCannelloniHeaderBytes;
    for (std::size_t i = 0; i < frames; ++i) {
        if (at + 5 > datagram.size() || datagram[at + 4] > 8) return std::nullopt;
        at += 5 + (is_remote(datagram, at) ? 0U : std::size_t{datagram[at + 4]});
        if (at > datagram.size()) return std::nullopt;
    }
    if (at != datagram.size()) return std::nullopt;
    return frames;
}

// The frame at `at`, which is moved behind it. `datagram` has been counted.
inline CanFrame take_frame(Bytes datagram, std::size_t& at) {
    CanFrame frame;
    const bool remote = is_remote(datagram, at);
    for (std::size_t i = 0; i < 4; ++i) frame.id = frame.id << 8U | datagram[at + i];
    frame.length = datagram[at + 4];
    at += 5;
    if (remote) return frame;
    for (std::size_t i = 0; i < frame.length; ++i) frame.data[i] = datagram[at + i];
    at += frame.length;
    return frame;
}

class CannelloniBus final : public CanBus {
  public:
    // `channel` outlives the bus.
    explicit CannelloniBus(Channel& channel) : channel_(&channel) {}

    void send(const CanFrame& frame) override {
        if (out_frames_ == kCannelloniFrames) flush();
        for (std::size_t i = 0; i < 4; ++i) {
            out_[out_bytes_++] = static_cast<std::uint8_t>(frame.id >> (24 - 8 * i));
        }
        out_[out_bytes_++] = frame.length;
        const std::size_t bytes = (frame.id & kCanRemote) != 0 ? 0U : std::size_t{frame.length};
        std::copy_n(frame.data.begin(), bytes, out_.begin() + static_cast<std::ptrdiff_t>(out_bytes_));
        out_bytes_ += bytes;
        ++out_frames_;
        ++counters_.sent;
    }

    void flush() override {
        if (out_frames_ == 0) return;
        out_[0] = kCannelloniVersion;
        out_[1] = kCannelloniData;
        out_[2] = sequence_++;
        out_[3] = static_cast<std::uint8_t>(out_frames_ >> 8U);
        out_[4] = static_cast<std::uint8_t>(out_frames_);
        channel_->send({out_.data(), out_bytes_});
        out_bytes_ = kCannelloniHeaderBytes;
        out_frames_ = 0;
    }

    bool receive(SessionTime now, CanFrame& frame) override {
        if (in_frames_ == 0 && !next_datagram(now)) return false;
        frame = take_frame(in_, in_at_);
        frame.order = in_order_;
        --in_frames_;
        ++counters_.received;
        return true;
    }

    bool down() const override { return false; }  // the interface is another machine's

  private:
    bool next_datagram(SessionTime now) {
        for (int refused = 0; refused < kMostRefusedAtOnce; ++refused) {
            in_ = channel_->receive();
            if (in_.empty()) return false;
            const auto frames = count_frames(in_);
            in_at_ = kCannelloniHeaderBytes;
            if (!frames) ++counters_.malformed;
            const bool taken = frames && take_sequence(channel_->arrival().value_or(now), in_[2]);
            in_frames_ = taken ? *frames : 0;
            if (in_frames_ > 0) return true;
        }
        return false;
    }

    // False: this datagram has been here before.
    bool take_sequence(SessionTime arrived, std::uint8_t sequence) {
        const auto ahead = static_cast<std::uint8_t>(sequence - newest_);
        const bool older = ahead == 0 || ahead > kMostAhead;
        if (older && newest_at_ != kNever && arrived - newest_at_ <= kSequenceForgotten) {
            in_order_ = newest_ - static_cast<std::uint8_t>(newest_ - sequence);
            const bool fresh = seen_.is_fresh(in_order_);
            ++(fresh ? counters_.late : counters_.repeated);
            if (fresh) seen_.accept(in_order_);
            return fresh;
        }
        in_order_ = newest_ += ahead == 0 ? 256U : ahead;
        newest_at_ = arrived;
        seen_.accept(newest_);
        return true;
    }

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
