#include <algorithm>

#include "tests/fuzz/checks.hpp"
#include "tests/unit/security/security_rig.hpp"

namespace thimble {
namespace {

constexpr std::size_t kMostMoves = 40;

// Reads a script; zeros behind its end.
class Script {
  public:
    explicit Script(Bytes bytes) : bytes_(bytes) {}
    bool over() const { return at_ >= bytes_.size(); }
    std::uint8_t next() { return over() ? std::uint8_t{0} : bytes_[at_++]; }
    Datagram take(std::size_t size) {
        size = std::min(size, bytes_.size() - std::min(at_, bytes_.size()));
        const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(at_);
        at_ += size;
        return {begin, begin + static_cast<std::ptrdiff_t>(size)};
    }

  private:
    Bytes bytes_;
    std::size_t at_ = 0;
};

class HandshakeCheck {
  public:
    explicit HandshakeCheck(Bytes bytes) : script_(bytes) {}

    Verdict run() {
        for (std::size_t i = 0; i < kMostMoves && !script_.over() && flaw_.empty(); ++i) move();
        return {rig_.session->established(), flaw_};
    }

  private:
    void move() {
        const std::uint8_t what = script_.next();
        TestWire& to = what & 0x80U ? rig_.wire.a : rig_.wire.b;
        switch (what & 7U) {
            case 0:
                to.deliver(script_.take(script_.next()));
                return hear(false);
            case 1:
            case 2:
                return change(to);
            case 3:
                rig_.node->send(bytes_of("node"));
                rig_.session->send(bytes_of("session"));
                words_said_ += 2;
                return hear(true);
            case 4:
                rig_.now += std::chrono::milliseconds{script_.next()};
                rig_.node->tick(rig_.now);
                rig_.session->tick(rig_.now);
                return hear(true);
            case 5:
                rig_.restart_node();
                return hear(true);
            default:
                rig_.node->tick(rig_.now);
                return hear(true);
        }
    }

    // A genuine datagram of either side, for either side, with any byte changed, or none.
    void change(TestWire& to) {
        const auto& said = script_.next() % 2 == 0 ? rig_.wire.a.said : rig_.wire.b.said;
        if (said.empty()) return;
        Datagram datagram = said[script_.next() % said.size()];
        datagram[script_.next() % datagram.size()] ^= script_.next();
        to.deliver(datagram);
        hear(false);
    }

    // A message is accepted no more often than it was sent, and no message that was not sent. One datagram completes
    // at most one handshake at each end: an accept that is let through completes it at the session, whose answer then
    // does at the node.
    void hear(bool genuine) {
        const std::uint32_t node = rig_.node->generation(), session = rig_.session->generation();
        listen(*rig_.session, "node");
        listen(*rig_.node, "session");
        const bool once = rig_.node->generation() <= node + 1 && rig_.session->generation() <= session + 1;
        if (!genuine && !once) flaw_ = "one datagram made more than one handshake at an end";
        if (words_taken_ > words_said_) flaw_ = "a word was taken twice";
    }

    void listen(SecurePair& end, const std::string& expected) {
        for (int i = 0; i < 4; ++i) {
            const std::string word = received(end);
            if (!word.empty()) ++words_taken_;
            if (!word.empty() && word != expected) flaw_ = "a word that nobody said was taken";
        }
    }

    Script script_;
    PairRig rig_;
    int words_said_ = 0, words_taken_ = 0;
    std::string flaw_;
};

}  // namespace

Verdict check_handshake(Bytes script) { return HandshakeCheck(script).run(); }

Verdict check_sealed(Bytes bytes) {
    SecretKey key;
    key.bytes.fill(5);
    Opener opener;
    opener.arm(key);
    SecurityCounters counters;
    std::array<std::uint8_t, kMaxDatagramBytes> text{};
    Verdict verdict;
    auto header = read_seal_header(bytes);
    if (header) {
        // As if the key's name had been guessed.
        Sealer sealer;
        sealer.arm(key);
        header->key_name = read_seal_header(sealer.seal(PacketKind::kData, header->port, {}))->key_name;
        if (opener.open(*header, bytes, text, counters)) verdict.flaw = "forged";
        if (counters.forged + counters.replayed != 1) verdict.flaw = "not counted";
    }
    KeyText written{};
    const auto came_back = [&](Bytes again, const char* flaw) {
        verdict.accepted = true;
        if (!std::ranges::equal(again, bytes)) verdict.flaw = flaw;
    };
    if (const auto grant = read_grant(bytes))
        came_back(write_grant(*grant, written), "a grant read differently");
    if (const auto receipt = read_receipt(bytes))
        came_back(write_receipt(*receipt, written), "a receipt read differently");
    return verdict;
}

}  // namespace thimble
