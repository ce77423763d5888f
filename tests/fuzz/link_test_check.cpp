#include <vector>

#include "tests/fuzz/checks.hpp"
#include "thimble/link_test/echo_responder.hpp"

namespace thimble {
namespace {

constexpr std::uint32_t kHost = 1;
constexpr std::uint64_t kNonce = 0x0123456789abcdef;
constexpr std::uint16_t kPort = 14;

void put(std::vector<std::uint8_t>& datagram, std::size_t at, std::uint64_t value, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes && at + i < datagram.size(); ++i)
        datagram[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
}

std::vector<std::uint8_t> datagram_of(Bytes data) {
    std::vector<std::uint8_t> datagram(data.begin() + 1, data.end());
    if ((data[0] & 1) != 0) put(datagram, 0, 0x01544c4854, 5);  // magic and version
    if ((data[0] & 2) != 0) put(datagram, 60, datagram.size(), 4);
    if ((data[0] & 4) != 0) put(datagram, 8, kNonce, 8);
    if ((data[0] & 8) != 0) put(datagram, 6, kPort, 2);
    return datagram;
}

std::string flaw_of(const ProbePacket& request, const std::vector<std::uint8_t>& answered, std::size_t size) {
    const auto answer = read_probe(answered);
    if (answered.size() != size) return "an answer of another length than its request";
    if (!answer) return "an answer that cannot be read";
    if (static_cast<int>(answer->kind) % 2 != 0) return "an answer that is a request";
    if (request.kind != ProbeKind::kHello && request.nonce != kNonce) return "an answer to a stranger";
    return "";
}

}  // namespace

Verdict check_link_test(Bytes bytes) {
    if (bytes.empty()) return {};
    EchoResponder responder({}, [] { return kNonce; });
    const SessionTime now{std::chrono::seconds{1}};
    std::vector<std::uint8_t> hello(kProbeHeaderBytes);
    ProbePacket packet;
    packet.port = kPort;
    write_probe(packet, hello);
    if (!responder.answer(now, now, kHost, kPort, hello)) return {false, "a greeting without an answer"};
    auto datagram = datagram_of(bytes);
    const auto request = read_probe(datagram);
    const std::size_t asked = datagram.size();
    if (!responder.answer(now, now, kHost, kPort, datagram)) return {};
    return {true, request ? flaw_of(*request, datagram, asked) : "an answer to nonsense"};
}

}  // namespace thimble
