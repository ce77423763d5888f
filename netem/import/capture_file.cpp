#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <pcap/pcap.h>

#include <fmt/format.h>

#include "common/error.hpp"
#include "netem/import/importers.hpp"

namespace thimble {
namespace {

constexpr std::size_t kUdpHeader = 8;
constexpr unsigned kIpv4 = 0x0800, kIpv6 = 0x86dd, kVlan = 0x8100, kServiceVlan = 0x88a8;
constexpr unsigned kUdp = 17;
// Extension headers of IPv6 that may stand before UDP (RFC 8200), and that of a fragment.
constexpr unsigned kHopByHop = 0, kRouting = 43, kFragment = 44, kDestinationOptions = 60;
constexpr std::int64_t kSecond_ns = 1'000'000'000;

unsigned byte_at(std::string_view bytes, std::size_t at) { return static_cast<std::uint8_t>(bytes[at]); }
unsigned big16(std::string_view bytes, std::size_t at) {
    return byte_at(bytes, at) << 8 | byte_at(bytes, at + 1);
}

// Behind a header of so many bytes, with the protocol at `at`.
std::optional<std::string_view> behind(std::string_view frame, std::size_t header, std::size_t at) {
    if (frame.size() < header || (big16(frame, at) != kIpv4 && big16(frame, at) != kIpv6)) return {};
    return frame.substr(header);
}

// The IP packet in a frame; nothing for other protocols and packets cut too short.
std::optional<std::string_view> ip_packet(std::string_view frame, int link_type) {
    std::size_t at = 12;
    switch (link_type) {
        case DLT_EN10MB:
            while (frame.size() >= at + 6 && (big16(frame, at) == kVlan || big16(frame, at) == kServiceVlan))
                at += 4;
            return behind(frame, at + 2, at);
        case DLT_NULL:  // a family before it, as the machine that captured numbers and orders it
            if (frame.size() < 4) return {};
            return frame.substr(4);
        case DLT_LINUX_SLL:
            return behind(frame, 16, 14);
        case DLT_LINUX_SLL2:
            return behind(frame, 20, 0);
        default:  // raw IP
            return frame;
    }
}

struct UdpPlace {
    std::size_t at = 0;  // 0: this is no UDP
    bool fragment = false;
};

UdpPlace find_udp4(std::string_view ip) {
    if (ip.size() < 20 || byte_at(ip, 9) != kUdp) return {};
    const std::size_t header = std::size_t{4} * (byte_at(ip, 0) & 15U);
    if (header < 20) return {};
    return {header, (big16(ip, 6) & 0x3fff) != 0};  // more to come, or an offset
}

// A fragment's header may say that the packet is whole.
UdpPlace find_udp6(std::string_view ip) {
    if (ip.size() < 40) return {};
    UdpPlace place{40};
    unsigned next = byte_at(ip, 6);
    while (next == kHopByHop || next == kRouting || next == kDestinationOptions || next == kFragment) {
        if (ip.size() < place.at + 8) return {};
        const bool fragment = next == kFragment;
        place.fragment = place.fragment || (fragment && (big16(ip, place.at + 2) & 0xfff9) != 0);
        next = byte_at(ip, place.at);
        place.at += fragment ? 8 : 8 * (std::size_t{byte_at(ip, place.at + 1)} + 1);
    }
    return next == kUdp ? place : UdpPlace{};
}

UdpPlace find_udp(std::string_view ip) {
    const unsigned version = ip.empty() ? 0 : byte_at(ip, 0) >> 4;
    if (version == 4) return find_udp4(ip);
    return version == 6 ? find_udp6(ip) : UdpPlace{};
}

// False if it is none. Lengths come from the headers: Ethernet pads short packets.
bool read_udp(std::string_view ip, std::int64_t stamp_ns, Capture& capture) {
    const auto [header, fragment] = find_udp(ip);
    if (header == 0) return false;
    if (fragment) {
        ++capture.fragments;
        return true;
    }
    if (ip.size() < header + kUdpHeader) return false;
    const std::size_t length = big16(ip, header + 4);
    if (length < kUdpHeader) return false;
    const std::string_view payload = ip.substr(header + kUdpHeader, length - kUdpHeader);
    capture.datagrams.push_back({.stamp_ns = stamp_ns,
                                 .to_port = static_cast<std::uint16_t>(big16(ip, header + 2)),
                                 .payload_bytes = static_cast<std::uint32_t>(length - kUdpHeader),
                                 .payload_hash = std::hash<std::string_view>{}(payload)});
    return true;
}

struct CloseCapture {
    void operator()(pcap_t* file) const { pcap_close(file); }
};

class CaptureParser {
  public:
    CaptureParser(std::string_view bytes, std::string_view name) : name_(name) {
        if (bytes.empty()) fail_as_none("it is empty");
        std::FILE* stream = fmemopen(const_cast<char*>(bytes.data()), bytes.size(), "rb");
        if (stream == nullptr) fail_as_none(std::strerror(errno));
        std::array<char, PCAP_ERRBUF_SIZE> why{};
        file_.reset(pcap_fopen_offline_with_tstamp_precision(stream, PCAP_TSTAMP_PRECISION_NANO, why.data()));
        if (file_ != nullptr) return;
        std::fclose(stream);
        fail_as_none(why.data());
    }

    Capture parse() {
        const int link_type = pcap_datalink(file_.get());
        if (!is_known(link_type)) {
            fail(fmt::format("link type {} is not Ethernet, Linux cooked, loopback or raw IP", link_type));
        }
        pcap_pkthdr* header = nullptr;
        const unsigned char* data = nullptr;
        int result = 0;
        for (; (result = pcap_next_ex(file_.get(), &header, &data)) == 1; ++packet_) {
            if (header->ts.tv_usec < 0 || header->ts.tv_usec >= kSecond_ns || header->ts.tv_sec < 0 ||
                header->ts.tv_sec > UINT32_MAX)
                fail("a time stamp out of range");
            const auto ip = ip_packet({reinterpret_cast<const char*>(data), header->caplen}, link_type);
            const std::int64_t stamp_ns = header->ts.tv_sec * kSecond_ns + header->ts.tv_usec;
            if (!ip || !read_udp(*ip, stamp_ns, capture_)) ++capture_.others;
            if (capture_.datagrams.size() > kMostPackets) fail("too many packets; split the capture");
        }
        const std::string_view why = pcap_geterr(file_.get());
        capture_.cut_at_end = result == PCAP_ERROR && (why.starts_with("truncated dump file") ||
                                                       why.starts_with("truncated pcapng dump file"));
        if (result == PCAP_ERROR && !capture_.cut_at_end) fail(why);
        return std::move(capture_);
    }

  private:
    static bool is_known(int link_type) {
        constexpr int kIpv4Alone = 228, kIpv6Alone = 229;
        for (const int known :
             {DLT_NULL, DLT_EN10MB, DLT_RAW, DLT_LINUX_SLL, kIpv4Alone, kIpv6Alone, DLT_LINUX_SLL2}) {
            if (link_type == known) return true;
        }
        return false;
    }
    [[noreturn]] void fail_as_none(std::string_view why) const {
        fail(fmt::format("not a capture ({}): make one with tcpdump -w", why));
    }
    [[noreturn]] void fail(std::string_view why) const {
        throw Error(ExitCode::kData, "{}: packet {}: {}", name_, packet_, why);
    }

    std::string_view name_;
    std::unique_ptr<pcap_t, CloseCapture> file_;
    Capture capture_;
    std::size_t packet_ = 1;
};

}  // namespace

Capture parse_capture(std::string_view bytes, std::string_view name) {
    return CaptureParser(bytes, name).parse();
}

}  // namespace thimble
