// The stand-alone relay: sockets, flows and links of one thread. Each client gets a flow of its own with a socket
// towards the server, as in a NAT; what the server sends to that socket goes back to the client.
//
//   client --> inlet socket --> link up --> flow's socket --> server
//   client <-- inlet socket <-- link down <-- flow's socket <--
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "common/runtime/stamp_clock.hpp"
#include "common/runtime/udp_socket.hpp"
#include "netem/link_model.hpp"
#include "netem/relay/datagram_batch.hpp"
#include "netem/relay/due_heap.hpp"
#include "netem/relay/flow_table.hpp"
#include "netem/relay/packet_record.hpp"
#include "netem/relay/relay_totals.hpp"
#include "netem/relay/send_lead.hpp"
#include "netem/relay/steered_relay.hpp"

namespace thimble {

// Part of every published seed, apart from the directions of a session (netem_settings.hpp).
inline constexpr std::uint32_t kRelayUp = 11, kRelayDown = 12;

// With the direction and the packet's number this decides a packet's fate.
inline StreamKey flow_key(std::uint64_t seed, std::uint32_t inlet, std::uint32_t flow) {
    return {.study = seed, .experiment = inlet, .subject = flow};
}

class RelayEngine final : public SteeredRelay {
  public:
    // Opens the inlets. `log` may be null and must outlive the engine. Throws Error (network) for a taken port.
    RelayEngine(const RelaySettings& settings, PacketSink* log);
    ~RelayEngine() override;

    // One wait, no longer than until `latest` or a tenth of a second, and what follows from it. Sends what is due before it
    // receives; what is due by the time it could be on its way counts as due (send_lead.hpp).
    void step(SessionTime latest);

    // From now on other links, for all flows; what is in flight keeps its fate.
    void change(SessionTime now, const LinkPair& links) override;

    RelayTotals totals(SessionTime now) const;
    // Without the counters of open flows, which totals() sums up.
    const RelayTotals& counted() const { return totals_; }
    RelayState state(SessionTime now) const override;
    UdpAddress inlet_address(std::size_t inlet) const { return inlets_[inlet].local(); }
    // Time zero of outages, timelines and traces by time. Slots begin with their flow.
    SessionTime start() const { return start_; }
    const EventWaiter& waiter() const { return waiter_; }
    // Lead time of sending, before the due time.
    Duration send_lead() const { return send_cost_ + handling_.least(); }

  private:
    struct Flow {
        UdpSocket server;
        std::array<LinkModel, 2> links;  // RelayDirection
        std::array<SessionTime, 2> last_received{};
        ReceiveTurn turn{};
        std::array<std::optional<DropLog>, 2> drops{};
    };
    // The packets that the batch sends.
    struct Outgoing {
        std::uint32_t link = 0;
        Departure departure;
    };

    void send_due(SessionTime now);
    void serve(std::uint32_t link, SessionTime now);
    void flush();
    void record_sent(const Outgoing& out, SessionTime sent, bool accepted);
    void receive(std::span<const epoll_event> events);
    std::size_t receive_turn(int descriptor, ReceiveTurn& turn);
    void receive_from_clients(std::uint32_t inlet);
    void receive_from_server(std::uint32_t place);
    void push(std::uint32_t link, const ReceiveBatch::Datagram& datagram, SessionTime received);
    std::optional<std::uint32_t> flow_of(const FlowName& name, SessionTime received, SessionTime now);
    bool open_flow(std::uint32_t place, SessionTime received);
    void close_flow(std::uint32_t place);
    void expire_flows(SessionTime now);
    void housekeep(SessionTime now);

    LinkModel& model(std::uint32_t link) { return flows_[link / 2]->links[link % 2]; }
    void name_link(PacketRecord& record, std::uint32_t link) const;
    void log_drops(Flow& flow, std::uint32_t place);

    RelaySettings settings_;
    PacketSink* log_;
    EventWaiter waiter_;
    const Duration send_cost_;
    LeastLately handling_;        // from the decision to send to the call that does
    SessionTime woken_ = kNever;  // by a due time, until the first packet has been handed over
    StampClock stamps_;
    std::vector<UdpSocket> inlets_;
    std::vector<ReceiveTurn> inlet_turns_;
    FlowTable table_;
    std::vector<std::unique_ptr<Flow>> flows_;  // by place; link 2 * place + direction
    DueHeap due_;
    std::vector<std::uint32_t> active_;  // links with due packets, in turn
    ReceiveBatch arrivals_;
    SendBatch batch_{false};         // until there is much to send (housekeep)
    std::uint64_t handed_over_ = 0;  // datagrams to the kernel, since the last housekeeping
    SessionTime last_housekeeping_;
    int batch_socket_ = -1;
    std::vector<Outgoing> outgoing_;
    RelayTotals totals_;  // without the counters of flows that are open
    SessionTime start_, next_housekeeping_, next_expiry_;
};

}  // namespace thimble
