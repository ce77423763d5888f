#include "netem/formats/capture_file.hpp"

#include <optional>

#include <fmt/format.h>

#include "common/error.hpp"
#include "netem/formats/measured_path.hpp"

namespace thimble {
namespace {

constexpr std::size_t kFileHeader = 24, kPacketHeader = 16;
constexpr std::size_t kUdpHeader = 8;
constexpr std::uint32_t kLongestPacket = 262'144;  // tcpdump's own limit
constexpr unsigned kIpv4 = 0x0800;
constexpr std::uint8_t kUdp = 17;

std::uint32_t byte_at(std::string_view bytes, std::size_t at) { return static_cast<std::uint8_t>(bytes[at]); }
std::uint32_t big16(std::string_view bytes, std::size_t at) {
    return byte_at(bytes, at) << 8 | byte_at(bytes, at + 1);
}

// FNV-1a: payloads are compared within one pair of captures, and equal ones are told apart by their order.
std::uint64_t hash_of(std::string_view bytes) {
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (const char c : bytes) hash = (hash ^ static_cast<std::uint8_t>(c)) * 0x100000001b3U;
    return hash;
}

// From the link's header to the IP packet; nothing for other protocols and packets cut too short.
std::optional<std::string_view> ip_packet(std::string_view frame, std::uint32_t link_type) {
    switch (link_type) {
        case 1: {  // Ethernet
            std::size_t at = 12;
            while (frame.size() >= at + 6 && (big16(frame, at) == 0x8100 || big16(frame, at) == 0x88a8))
                at += 4;
            if (frame.size() < at + 2 || big16(frame, at) != kIpv4) return {};
            return frame.substr(at + 2);
        }
        case 0:  // BSD loopback: the family in the byte order of the machine
            if (frame.size() < 4 || (byte_at(frame, 0) != 2 && byte_at(frame, 3) != 2)) return {};
            return frame.substr(4);
        case 12:
        case 101:
        case 228:  // raw IP
            return frame;
        case 113:  // Linux cooked
            if (frame.size() < 16 || big16(frame, 14) != kIpv4) return {};
            return frame.substr(16);
        case 276:  // Linux cooked, version 2
            if (frame.size() < 20 || big16(frame, 0) != kIpv4) return {};
            return frame.substr(20);
        default:
            return {};
    }
}

class CaptureParser {
  public:
    CaptureParser(std::string_view bytes, std::string_view name) : bytes_(bytes), name_(name) {}

    Capture parse() {
        read_file_header();
        std::size_t at = kFileHeader;
        while (at < bytes_.size()) {
            if (bytes_.size() - at < kPacketHeader) {
                capture_.cut_at_end = true;
                break;
            }
            const std::uint32_t kept = number(at + 8);
            if (kept > kLongestPacket) {
                fail(at, fmt::format("a packet of {} bytes, more than {}", kept, kLongestPacket));
            }
            if (bytes_.size() - at - kPacketHeader < kept) {
                capture_.cut_at_end = true;
                break;
            }
            read_packet(at, bytes_.substr(at + kPacketHeader, kept));
            at += kPacketHeader + kept;
        }
        return std::move(capture_);
    }

  private:
    [[noreturn]] void fail(std::size_t at, const std::string& why) const {
        throw Error(ExitCode::kData, fmt::format("{}: byte {}: {}", name_, at, why));
    }
    std::uint32_t number(std::size_t at) const {
        std::uint32_t little = 0;
        for (unsigned i = 0; i < 4; ++i) little |= byte_at(bytes_, at + i) << (8 * i);
        return swapped_ ? little >> 24 | (little >> 8 & 0xff00) | (little << 8 & 0xff0000) | little << 24
                        : little;
    }

    void read_file_header() {
        if (bytes_.size() < kFileHeader) fail(0, "too short for a pcap file");
        switch (number(0)) {
            case 0xa1b2c3d4:
                break;
            case 0xa1b23c4d:
                unit_ns_ = 1;
                break;
            case 0xd4c3b2a1:
                swapped_ = true;
                break;
            case 0x4d3cb2a1:
                swapped_ = true;
                unit_ns_ = 1;
                break;
            case 0x0a0d0d0a:
                fail(0,
                     "this is pcapng: convert it with `editcap -F pcap IN OUT` or capture with tcpdump -w");
            default:
                fail(0, "no pcap file: capture with tcpdump -w");
        }
        link_type_ = number(20) & 0x0fffffff;
        for (const std::uint32_t known : {0U, 1U, 12U, 101U, 113U, 228U, 276U}) {
            if (link_type_ == known) return;
        }
        fail(20,
             fmt::format("link type {} is none of Ethernet, Linux cooked, loopback and raw IP", link_type_));
    }

    void read_packet(std::size_t at, std::string_view frame) {
        const std::int64_t fraction = number(at + 4);
        if (fraction * unit_ns_ >= 1'000'000'000) fail(at + 4, "a time stamp beyond its second");
        const auto ip = ip_packet(frame, link_type_);
        if (!ip || !read_udp(*ip, std::int64_t{number(at)} * 1'000'000'000 + fraction * unit_ns_)) {
            ++capture_.others;
        }
        if (capture_.datagrams.size() > kMostPackets) fail(at, "too many packets; split the capture");
    }

    // False if it is none. Lengths come from the headers: Ethernet pads short packets.
    bool read_udp(std::string_view ip, std::int64_t stamp_ns) {
        if (ip.size() < 20 || byte_at(ip, 0) >> 4 != 4 || byte_at(ip, 9) != kUdp) return false;
        const std::size_t header = std::size_t{4} * (byte_at(ip, 0) & 15U);
        if (header < 20 || ip.size() < header + kUdpHeader) return false;
        if ((big16(ip, 6) & 0x3fff) != 0) {  // more to come, or an offset
            ++capture_.fragments;
            return true;
        }
        const std::uint32_t length = big16(ip, header + 4);
        if (length < kUdpHeader) return false;
        CapturedDatagram datagram;
        datagram.stamp_ns = stamp_ns;
        datagram.from_port = static_cast<std::uint16_t>(big16(ip, header));
        datagram.to_port = static_cast<std::uint16_t>(big16(ip, header + 2));
        datagram.payload_bytes = static_cast<std::uint32_t>(length - kUdpHeader);
        const std::string_view payload = ip.substr(header + kUdpHeader, datagram.payload_bytes);
        datagram.cut = payload.size() < datagram.payload_bytes;
        datagram.payload_hash = hash_of(payload);
        capture_.datagrams.push_back(datagram);
        return true;
    }

    std::string_view bytes_;
    std::string_view name_;
    Capture capture_;
    bool swapped_ = false;
    std::int64_t unit_ns_ = 1000;
    std::uint32_t link_type_ = 0;
};

}  // namespace

Capture parse_capture(std::string_view bytes, std::string_view name) {
    return CaptureParser(bytes, name).parse();
}

}  // namespace thimble
