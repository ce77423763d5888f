// A view whose address changes: the session follows the view's newest sealed datagram, and no other.
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>

#include "common/runtime/sockets.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/security/lab_key_file.hpp"
#include "tests/guarded_ports.hpp"
#include "tests/unit/common/packet.hpp"
#include "tests/unit/security/security_rig.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
constexpr const char* kSessionHost = "127.0.0.1";
constexpr const char* kViewHost = "127.0.0.2";
constexpr const char* kOtherHost = "127.0.0.3";
constexpr SecurePair::Ends kViewEnds{Port::kExperimenterMonitor, Port::kSessionOrders};

// The view's socket, which another one replaces.
class MovableWire final : public Channel {
  public:
    void move_to(const Endpoint& here, const Endpoint& session) {
        socket_ = std::make_unique<UdpChannel>(here, session);
    }
    void send(Bytes datagram) override {
        said.emplace_back(datagram.begin(), datagram.end());
        if (!cut) socket_->send(datagram);
    }

    bool cut = false;
    std::vector<Datagram> said;

  private:
    Bytes take() override { return socket_->receive(); }
    std::unique_ptr<UdpChannel> socket_;
};

class MovedView : public testing::Test {
  protected:
    MovedView() {
        at_session_.let_peer_move();
        wire_.move_to({kViewHost, port_}, session_end());
    }
    Endpoint session_end() const { return {kSessionHost, port_of(at_session_)}; }
    void turn() {
        wall_sleep(milliseconds{1});
        now_ += milliseconds{110};
        session_.tick(now_);
        view_.tick(now_);
    }
    // `from` says it again and again.
    bool arrives(SecurePair& from, SecurePair& to, const std::string& text) {
        for (int i = 0; i < 2000; ++i) {
            turn();
            from.send(bytes_of(text));
            received(from);
            if (received(to) == text) return true;
        }
        return false;
    }
    void session_hears_until(const std::function<bool()>& done) {
        for (int i = 0; i < 2000 && !done(); ++i) {
            wall_sleep(milliseconds{1});
            text_ += received(session_);
        }
        EXPECT_TRUE(done());
    }

    SessionTime now_{std::chrono::hours{5}};
    std::uint16_t port_ = port_of(UdpChannel{Endpoint{kViewHost, 0}, Endpoint{kSessionHost, 0}});
    UdpChannel at_session_{Endpoint{kSessionHost, 0}, Endpoint{kViewHost, port_}};
    MovableWire wire_;
    std::shared_ptr<const LabKey> key_ = test_lab_key();
    SecurePair session_{
        at_session_, *key_, {Port::kSessionOrders, Port::kExperimenterMonitor}, seeded_bytes(1), {}};
    SecurePair view_{wire_, *key_, kViewEnds, seeded_bytes(2), {}};
    UdpChannel stranger_{Endpoint{kOtherHost, 0}, session_end()};
    std::string text_;
};

TEST_F(MovedView, GoesOnWithoutANewStart) {
    ASSERT_TRUE(arrives(session_, view_, "before"));
    wire_.move_to({kOtherHost, 0}, session_end());
    EXPECT_TRUE(arrives(session_, view_, "after"));
    EXPECT_TRUE(arrives(view_, session_, "order"));
}

// Its keys are gone, and the session does not know where it is.
TEST_F(MovedView, MayStartAnewElsewhere) {
    ASSERT_TRUE(arrives(session_, view_, "before"));
    MovableWire elsewhere;
    elsewhere.move_to({kOtherHost, 0}, session_end());
    SecurePair again(elsewhere, *key_, kViewEnds, seeded_bytes(3), {});
    for (int i = 0; i < 2000 && !again.established(); ++i) {
        turn();
        again.tick(now_);
        received(session_);
        received(again);
    }
    EXPECT_TRUE(again.established());
}

// Replayed, changed, and held back until a newer word has come: the last is a word of the view, but not its newest.
TEST_F(MovedView, IsNotWhoeverRepeatsItsWords) {
    ASSERT_TRUE(arrives(session_, view_, "before") && arrives(view_, session_, "order"));
    for (Datagram datagram : wire_.said) {
        stranger_.send(datagram);
        datagram.back() ^= 1U;
        stranger_.send(datagram);
    }
    wire_.cut = true;
    view_.send(bytes_of("held back"));
    const Datagram held = wire_.said.back();
    wire_.cut = false;
    view_.send(bytes_of("newer"));
    session_hears_until([this] { return text_.find("newer") != std::string::npos; });
    stranger_.send(held);
    session_hears_until([this] { return text_.find("held back") != std::string::npos; });
    EXPECT_GT(session_.counters().replayed, 0U);
    EXPECT_TRUE(arrives(session_, view_, "still here"));
    for (Bytes datagram = stranger_.receive(); !datagram.empty(); datagram = stranger_.receive())
        EXPECT_EQ(read_seal_header(datagram)->kind, PacketKind::kOffer)
            << "an answer to a hello, and no word";
}

// Only the session's end towards a view and the stop buses hear other hosts.
TEST(MovedViews, AreTheOnlyOnesThatAreHeardFromElsewhere) {
    const std::filesystem::path key = testing::TempDir() + "moved-view-" + std::to_string(getpid()) + ".key";
    create_lab_key(key, system_random_bytes());
    const GuardedPorts ports;
    NetworkSettings settings;
    settings.security = {SecurityMode::kLabKey, false, key.string(), ""};
    settings.base_port = ports.base();
    Sockets sockets(settings);
    std::filesystem::remove(key);
    Channel* const view = sockets.between(Port::kSessionOrders, Port::kExperimenterMonitor);
    Channel* const node = sockets.between(Port::kSessionMaster, Port::kMasterControl);
    Channel* const stops = sockets.inlet(Port::kSessionStop);
    UdpChannel to_view(Endpoint{kOtherHost, 0}, settings.at(Port::kSessionOrders)),
        to_node(Endpoint{kOtherHost, 0}, settings.at(Port::kSessionMaster)),
        to_stops(Endpoint{kOtherHost, 0}, settings.at(Port::kSessionStop));
    to_view.send(bytes_of("to the view's port"));
    to_stops.send(bytes_of("to the port of stops"));
    to_node.send(bytes_of("to the node's port"));
    for (int i = 0; i < 2000 && sockets.counters().foreign_source == 0; ++i) {
        wall_sleep(milliseconds{1});
        received(*view);
        received(*stops);
        received(*node);
    }
    EXPECT_EQ(sockets.counters().foreign_source, 1U);
    EXPECT_EQ(sockets.security()->counters().unsealed, 2U);
}

}  // namespace
}  // namespace thimble
