#include <algorithm>
#include <numeric>
#include <variant>

#include "common/codec.hpp"
#include "common/security/stop_seal.hpp"
#include "common/stop_bus.hpp"
#include "tests/fuzz/checks.hpp"
#include "tests/unit/security/security_rig.hpp"

namespace thimble {
namespace {

constexpr std::uint16_t kStopPort = 27028;
// Fewer than make the line forget a number (it remembers 128): of a release that it has forgotten nothing is known.
constexpr std::size_t kMostStopMoves = 24;

// One for all runs: a key has memory of its own with guard pages, which takes longer than a run.
const std::shared_ptr<const LabKey>& stop_lab_key() {
    static const std::shared_ptr<const LabKey> key = test_lab_key();
    return key;
}

class StopCheck {
  public:
    explicit StopCheck(Bytes script) : script_(script) {
        here_.connect(seal_here_, {&sink_, &sink_, &sink_, &sink_, &sink_, &sink_});
        there_.connect(seal_there_, {&seal_there_, &sink_, &sink_, &sink_, &sink_, &sink_});
    }

    Verdict run() {
        Verdict verdict;
        for (std::size_t i = 0; i < kMostStopMoves && at_ < script_.size() && verdict.flaw.empty(); ++i) {
            const bool before = here_.stopped();
            released_ = false;
            move();
            here_.tick(now_);
            if (here_.stopped() && !said_stop_) verdict.flaw = "stopped, and nobody said so";
            if (before && !here_.stopped() && !released_) verdict.flaw = "let go, and nobody released it";
            verdict.accepted = verdict.accepted || here_.stopped();
        }
        return verdict;
    }

  private:
    std::uint8_t next() { return at_ < script_.size() ? script_[at_++] : std::uint8_t{0}; }

    void move() {
        switch (next() % 5) {
            case 0:
                return made_up();
            case 1:
                return changed();
            case 2:
                there_.stop(now_, EndReason::kEmergencyStop, "smoke");
                said_stop_ = true;
                return;
            case 3:
                there_.release(now_);
                said_release_ = released_ = true;
                return;
            default:
                now_ += std::chrono::milliseconds{next()};
                there_.tick(now_);
                released_ = said_release_;  // it is said several times over
        }
    }

    void made_up() {
        const std::size_t size = std::min<std::size_t>(next(), script_.size() - at_);
        const auto begin = script_.begin() + static_cast<std::ptrdiff_t>(at_);
        wire_.a.deliver({begin, begin + static_cast<std::ptrdiff_t>(size)});
        at_ += size;
    }

    // Said before, by the other end, with a byte changed or none. Released stops stay released, a known release releases nothing.
    void changed() {
        if (wire_.b.said.empty()) return;
        Datagram datagram = wire_.b.said[next() % wire_.b.said.size()];
        datagram[next() % datagram.size()] ^= next();
        wire_.a.deliver(datagram);
    }

    Bytes script_;
    std::size_t at_ = 0;
    SessionTime now_{std::chrono::hours{1}};
    TestPipe wire_;  // a: the program's end, b: the experimenter's
    TestWire sink_;
    StopSeal seal_here_{wire_.a, stop_lab_key(), kStopPort, StopEnd::kListens};
    StopSeal seal_there_{wire_.b, stop_lab_key(), kStopPort, StopEnd::kSpeaks};
    StopBus here_{Role::kMaster, 1}, there_{Role::kExperimenter, 2};
    bool said_stop_ = false, said_release_ = false;
    bool released_ = false;  // in this move
};

Verdict check_open_end(Bytes bytes) {
    TestWire wire;
    StopBus line(Role::kMaster, 1);
    line.connect(wire, {&wire, &wire, &wire, &wire, &wire, &wire});
    wire.deliver({bytes.begin(), bytes.end()});
    line.tick(SessionTime{std::chrono::hours{1}});
    const FlowCounters& counters = line.counters();
    const std::uint64_t counted =
        std::accumulate(counters.refused.begin(), counters.refused.end(), counters.accepted);
    Verdict verdict;
    verdict.accepted = line.stopped();
    if (counted != (bytes.empty() ? 0U : 1U)) verdict.flaw = "not counted once";
    if (line.stopped() && line.words().size() > StopOrder{}.text.size())
        verdict.flaw = "words beyond their end";
    if (line.stopped() && !is_stop(line.reason())) verdict.flaw = "stopped for a reason that is no stop";
    return verdict;
}

}  // namespace

Verdict check_stop(Bytes bytes) {
    if (bytes.empty()) return {};
    const Bytes rest = bytes.subspan(1);
    return bytes[0] % 2 == 0 ? StopCheck(rest).run() : check_open_end(rest);
}

}  // namespace thimble
