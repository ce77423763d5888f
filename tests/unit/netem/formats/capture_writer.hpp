// Writes pcap files for tests, with every link type that the reader takes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace thimble::test {

struct FrameOptions {
    bool vlan = false;
    std::size_t padding = 0;
    std::uint8_t protocol = 17;
    bool fragment = false;
    bool v6 = false;
    bool options = false;  // of IPv6, before the datagram
};

class CaptureWriter {
  public:
    explicit CaptureWriter(std::uint32_t link_type) : link_type_(link_type) {
        for (const std::uint32_t word : {0xa1b23c4dU, 0x00040002U, 0U, 0U, 65535U, link_type}) file32(word);
    }

    void udp(std::int64_t stamp_ns, std::uint16_t from, std::uint16_t to, std::string_view payload,
             const FrameOptions& options = {}) {
        std::string frame = link_header(options);
        frame += options.v6 ? ip6_header(payload.size(), options) : ip_header(payload.size(), options);
        for (const std::size_t half :
             {std::size_t{from}, std::size_t{to}, payload.size() + 8, std::size_t{0}}) {
            put16(frame, half);
        }
        frame += payload;
        frame += std::string(options.padding, '\0');
        file32(static_cast<std::uint32_t>(stamp_ns / 1'000'000'000));
        file32(static_cast<std::uint32_t>(stamp_ns % 1'000'000'000));
        file32(static_cast<std::uint32_t>(frame.size()));
        file32(static_cast<std::uint32_t>(frame.size()));
        bytes_ += frame;
    }

    const std::string& bytes() const { return bytes_; }

  private:
    static void put16(std::string& out, std::size_t value) {
        out += static_cast<char>(value >> 8 & 255);
        out += static_cast<char>(value & 255);
    }
    void file32(std::uint32_t value) {
        for (unsigned i = 0; i < 4; ++i) bytes_ += static_cast<char>(value >> 8 * i & 255);
    }
    std::string link_header(const FrameOptions& options) const {
        const std::string type(options.v6 ? "\x86\xdd" : "\x08\x00", 2);
        switch (link_type_) {
            case 0:
                return {static_cast<char>(options.v6 ? 10 : 2), 0, 0, 0};
            case 1:
                return std::string(12, '\x02') + std::string("\x81\x00\x00\x05", options.vlan ? 4 : 0) + type;
            case 113:
                return std::string(14, '\0') + type;
            case 276:
                return type + std::string(18, '\0');
            default:
                return {};
        }
    }
    static std::string ip_header(std::size_t payload, const FrameOptions& options) {
        std::string header("\x45\x00", 2);
        put16(header, payload + 28);
        put16(header, 0);
        put16(header, options.fragment ? 0x2000 : 0x4000);  // more fragments, or do not fragment
        header += static_cast<char>(64);
        header += static_cast<char>(options.protocol);
        return header + std::string(10, '\x01');
    }
    static std::string ip6_header(std::size_t payload, const FrameOptions& options) {
        const auto protocol = static_cast<char>(options.protocol);
        const char inner = options.fragment ? char{44} : protocol;
        std::string more;
        if (options.options) more += std::string{inner, 0, 1, 4, 0, 0, 0, 0};
        if (options.fragment) more += std::string{protocol, 0, 0, 1, 0, 0, 0, 7};
        std::string header("\x60\x00\x00\x00", 4);
        put16(header, payload + 8 + more.size());
        header += std::string{options.options ? char{60} : inner, 64};
        return header + std::string(32, '\x01') + more;
    }

    std::uint32_t link_type_;
    std::string bytes_;
};

}  // namespace thimble::test
