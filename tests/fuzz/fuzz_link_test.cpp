// libFuzzer on the far side of a link test: whatever comes, an answer is as long as what it answers, is no request, and goes
// to nobody without a nonce. The first byte chooses what is made right, so that the deeper checks are reached.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "thimble/link_test/echo_responder.hpp"

namespace {

using namespace thimble;

constexpr std::uint32_t kHost = 1;
constexpr std::uint64_t kNonce = 0x0123456789abcdef;
constexpr std::uint16_t kPort = 14;

void put(std::vector<std::uint8_t>& datagram, std::size_t at, std::uint64_t value, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes && at + i < datagram.size(); ++i)
        datagram[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
}

std::vector<std::uint8_t> datagram_of(const std::uint8_t* data, std::size_t size) {
    std::vector<std::uint8_t> datagram(data + 1, data + size);
    if ((data[0] & 1) != 0) put(datagram, 0, 0x01544c4854, 5);  // magic and version
    if ((data[0] & 2) != 0) put(datagram, 60, datagram.size(), 4);
    if ((data[0] & 4) != 0) put(datagram, 8, kNonce, 8);
    if ((data[0] & 8) != 0) put(datagram, 6, kPort, 2);
    return datagram;
}

const char* flaw_of(const ProbePacket& request, const std::vector<std::uint8_t>& answered, std::size_t size) {
    const auto answer = read_probe(answered);
    if (answered.size() != size) return "an answer of another length than its request";
    if (!answer) return "an answer that cannot be read";
    if (static_cast<int>(answer->kind) % 2 != 0) return "an answer that is a request";
    if (request.kind != ProbeKind::kHello && request.nonce != kNonce) return "an answer to a stranger";
    return nullptr;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    EchoResponder responder({}, [] { return kNonce; });
    const SessionTime now{std::chrono::seconds{1}};
    std::vector<std::uint8_t> hello(kProbeHeaderBytes);
    ProbePacket packet;
    packet.port = kPort;
    write_probe(packet, hello);
    if (!responder.answer(now, now, kHost, kPort, hello)) std::abort();
    auto datagram = datagram_of(data, size);
    const auto request = read_probe(datagram);
    const std::size_t asked = datagram.size();
    const bool answered = responder.answer(now, now, kHost, kPort, datagram);
    const char* flaw = nullptr;
    if (answered) flaw = request ? flaw_of(*request, datagram, asked) : "an answer to nonsense";
    if (flaw != nullptr) {
        std::fprintf(stderr, "fuzz_link_test: %s\n", flaw);
        std::abort();
    }
    return 0;
}
