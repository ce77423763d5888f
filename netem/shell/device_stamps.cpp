#include "netem/shell/device_stamps.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <atomic>
#include <cstring>
#include <linux/filter.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>

namespace thimble {
namespace {

constexpr unsigned kSnapBytes = 48;  // headers of IP and UDP, and some of what follows
constexpr unsigned kEntryBytes = 256, kBlockBytes = 1U << 16, kBlocks = 16;
constexpr std::size_t kEntries = std::size_t{kBlocks} * kBlockBytes / kEntryBytes;
constexpr std::size_t kRingBytes = std::size_t{kBlocks} * kBlockBytes;
constexpr std::size_t kLookAhead = 64;  // as many without a match are of packets that the device dropped

// Only what leaves by the device, and only its beginning.
bool keep_outgoing(int socket) {
    std::array<sock_filter, 4> steps{
        {BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<__u32>(SKF_AD_OFF + SKF_AD_PKTTYPE)),
         BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, PACKET_OUTGOING, 0, 1), BPF_STMT(BPF_RET | BPF_K, kSnapBytes),
         BPF_STMT(BPF_RET | BPF_K, 0)}};
    const sock_fprog program{steps.size(), steps.data()};
    return setsockopt(socket, SOL_SOCKET, SO_ATTACH_FILTER, &program, sizeof program) == 0;
}

bool share_ring(int socket) {
    const int version = TPACKET_V2;
    tpacket_req request{};
    request.tp_block_size = kBlockBytes;
    request.tp_block_nr = kBlocks;
    request.tp_frame_size = kEntryBytes;
    request.tp_frame_nr = kEntries;
    return setsockopt(socket, SOL_PACKET, PACKET_VERSION, &version, sizeof version) == 0 &&
           setsockopt(socket, SOL_PACKET, PACKET_RX_RING, &request, sizeof request) == 0;
}

bool listen_to(int socket, const std::string& device) {
    sockaddr_ll address{};
    address.sll_family = AF_PACKET;
    address.sll_protocol = htons(ETH_P_ALL);
    address.sll_ifindex = static_cast<int>(if_nametoindex(device.c_str()));
    return bind(socket, static_cast<sockaddr*>(static_cast<void*>(&address)), sizeof address) == 0;
}

tpacket2_hdr header_of(const std::uint8_t* entry) {
    tpacket2_hdr header{};
    std::memcpy(&header, entry, sizeof header);
    return header;
}

bool is_of(Bytes packet, const tpacket2_hdr& header, const std::uint8_t* entry) {
    const std::size_t size =
        std::min({std::size_t{header.tp_snaplen}, std::size_t{kSnapBytes}, packet.size()});
    return header.tp_len == packet.size() &&
           std::equal(packet.begin(), packet.begin() + static_cast<std::ptrdiff_t>(size),
                      entry + header.tp_mac);
}

std::atomic_ref<std::uint32_t> status_of(std::uint8_t* entry) {
    return std::atomic_ref<std::uint32_t>(*static_cast<std::uint32_t*>(static_cast<void*>(entry)));
}

}  // namespace

int open_stamp_socket(const std::string& device) {
    const int opened = socket(AF_PACKET, SOCK_RAW | SOCK_CLOEXEC, 0);
    if (opened < 0) return -1;
    if (keep_outgoing(opened) && share_ring(opened) && listen_to(opened, device)) return opened;
    close(opened);
    return -1;
}

DeviceStamps::DeviceStamps(int socket) {
    if (socket < 0) return;
    void* const shared = mmap(nullptr, kRingBytes, PROT_READ | PROT_WRITE, MAP_SHARED, socket, 0);
    if (shared != MAP_FAILED) ring_ = static_cast<std::uint8_t*>(shared);
}

DeviceStamps::~DeviceStamps() {
    if (ring_ != nullptr) munmap(ring_, kRingBytes);
}

// Null: the kernel has not written it.
const std::uint8_t* DeviceStamps::entry(std::size_t ahead) const {
    std::uint8_t* const found = ring_ + (next_ + ahead) % kEntries * kEntryBytes;
    return (status_of(found).load(std::memory_order_acquire) & TP_STATUS_USER) != 0 ? found : nullptr;
}

void DeviceStamps::release(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        status_of(ring_ + next_ * kEntryBytes).store(TP_STATUS_KERNEL, std::memory_order_release);
        next_ = (next_ + 1) % kEntries;
    }
}

SessionTime DeviceStamps::of(Bytes packet, SessionTime now) {
    if (ring_ == nullptr) return now;
    std::size_t seen = 0;
    while (const std::uint8_t* const found = entry(seen)) {
        const tpacket2_hdr header = header_of(found);
        const bool matches = is_of(packet, header, found);
        if (++seen == kLookAhead || matches) release(std::exchange(seen, 0));
        if (matches)
            return clock_.to_session(std::int64_t{header.tp_sec} * 1'000'000'000 + header.tp_nsec, now);
    }
    ++missing_;
    return now;
}

}  // namespace thimble
