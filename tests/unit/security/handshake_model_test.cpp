// Every state that an attacker can bring the handshake into, and random walks in which the real code must do what the model does.
#include "tests/unit/security/handshake_model.hpp"

#include <algorithm>
#include <deque>
#include <string>
#include <unordered_set>

#include <gtest/gtest.h>

#include "common/random.hpp"
#include "tests/unit/security/security_rig.hpp"

namespace thimble {
namespace {

using model::Agreed;
using model::Bound;
using model::End;
using model::Place;
using model::Word;

struct World {
    std::vector<End> ends;
    std::vector<Word> known;  // to the attacker, in order

    bool learn(const Word& word) {
        const auto at = std::lower_bound(known.begin(), known.end(), word);
        if (at != known.end() && *at == word) return false;
        known.insert(at, word);
        return true;
    }
    std::string name() const {
        return std::string(reinterpret_cast<const char*>(ends.data()), ends.size() * sizeof(End))
            .append(reinterpret_cast<const char*>(known.data()), known.size() * sizeof(Word));
    }
};
static_assert(std::has_unique_object_representations_v<Word> && sizeof(End) == 12);

// Two ends with one key that are not each other's peers, or an end whose peer never had that key.
bool is_wrong(const World& world) {
    return std::any_of(world.ends.begin(), world.ends.end(), [](const End& end) {
        return end.holds.lab != 0 && (model::place_of(end.holds.initiator) != end.place ||
                                      model::place_of(end.holds.responder) != end.place);
    });
}

struct Found {
    std::size_t states = 0, agreements = 0;
    bool wrong = false;
};

class Search {
  public:
    // `keys`: how many one-time keys each end may have, so how often it begins anew.
    Search(const std::vector<Place>& places, const Bound& bound, std::uint8_t keys) {
        visit({model::ends_at(places, bound, keys), {}});
    }
    Found run() {
        for (; !waiting_.empty() && !found_.wrong; waiting_.pop_front()) {
            const World world = waiting_.front();
            for (std::size_t i = 0; i < world.ends.size(); ++i) {
                for (const Word& word : world.known) deliver(world, i, word);
                start_anew(world, i);
            }
        }
        return found_;
    }

  private:
    void deliver(World world, std::size_t i, const Word& word) {
        if (const auto answer = world.ends[i].take(word)) world.learn(*answer);
        visit(std::move(world));
    }
    void start_anew(World world, std::size_t i) {
        End& end = world.ends[i];
        if (end.life == end.most) return;
        end.renew(true);
        visit(std::move(world));
    }
    // Hellos, and what a session's end says to them, cost nothing and change no end: the attacker has them at once.
    void visit(World world) {
        for (const End& end : std::vector(world.ends)) {
            if (end.initiator && end.own != 0) world.learn(end.says(PacketKind::kHello, 0));
        }
        for (const Word& word : std::vector(world.known)) {
            for (End& end : world.ends) {
                if (end.initiator || word.kind != PacketKind::kHello || end.own == 0) continue;
                world.learn(*end.take(word));
            }
        }
        if (!seen_.insert(world.name()).second) return;
        ++found_.states;
        found_.agreements += static_cast<std::size_t>(std::count_if(
            world.ends.begin(), world.ends.end(), [](const End& end) { return end.holds.lab != 0; }));
        found_.wrong = found_.wrong || is_wrong(world);
        waiting_.push_back(std::move(world));
    }

    Found found_;
    std::unordered_set<std::string> seen_;
    std::deque<World> waiting_;
};

const std::vector<Place> kTwoRigs{{0, 0}, {1, 0}}, kTwoRoles{{0, 0}, {0, 1}},
    kAll{{0, 0}, {0, 1}, {1, 0}, {1, 1}};

TEST(HandshakeModel, NoStateHasTwoEndsThatAgreeAcrossRigsRolesOrPeers) {
    const std::vector<std::pair<std::vector<Place>, std::uint8_t>> searches{
        {kTwoRigs, 2}, {kTwoRoles, 2}, {kAll, 1}, {{{0, 0}}, 3}};
    for (const auto& [places, keys] : searches) {
        const Found found = Search(places, Bound{}, keys).run();
        EXPECT_FALSE(found.wrong) << places.size();
        EXPECT_GT(found.agreements, 0U);
        RecordProperty("states_" + std::to_string(places.size()), static_cast<int>(found.states));
        EXPECT_GT(found.states, 50U) << places.size();
    }
}

// The same search finds the attack where the binding is missing: so it can fail.
TEST(HandshakeModel, WithoutRigOrRoleInTheCodeTheMiddleManJoinsThem) {
    EXPECT_TRUE(Search(kTwoRigs, Bound{false, true}, 1).run().wrong);
    EXPECT_TRUE(Search(kTwoRoles, Bound{true, false}, 1).run().wrong);
}

// A real end and its model: both get the same messages.
struct Both {
    End model;
    std::unique_ptr<TestWire> wire;
    std::shared_ptr<const LabKey> lab;
    std::unique_ptr<SecurePair> real;
    std::vector<Agreed> had{};

    std::optional<Word> take(const Word& word) {
        const auto answer = model.take(word);
        const Agreed newest = model.initiator && model.pending != 0 ? model.with(model.pending) : model.holds;
        if (std::find(had.begin(), had.end(), newest) == had.end()) had.push_back(newest);
        return answer;
    }
};

struct Said {
    Word word;
    Datagram datagram;
};

class Walk {
  public:
    explicit Walk(std::uint64_t seed) : random_(StreamKey{seed, 0, 0, 0, Purpose::kInstance}) {
        std::uint64_t number = 0;
        for (const End& end : model::ends_at(kAll, Bound{})) {
            const bool master = end.role == 0;
            const Port node = master ? Port::kMasterControl : Port::kSlaveControl,
                       session = master ? Port::kSessionMaster : Port::kSessionSlave;
            Both both{end,
                      std::make_unique<TestWire>(),
                      std::make_shared<const LabKey>(key_of_rig(*test_lab_key(), std::to_string(end.lab))),
                      {}};
            const auto ends =
                end.initiator ? SecurePair::Ends{node, session} : SecurePair::Ends{session, node};
            both.real = std::make_unique<SecurePair>(*both.wire, *both.lab, ends,
                                                     seeded_bytes(1000 * seed + ++number), SecurityTimes{});
            both.real->tick(now_);
            if (end.initiator) said_.push_back({end.says(PacketKind::kHello, 0), both.wire->said.back()});
            ends_.push_back(std::move(both));
        }
    }

    // Tells any end what any end has said. The real one must answer, and agree, where the model does.
    void step() {
        Both& end = ends_[random_.below(static_cast<std::uint32_t>(ends_.size()))];
        const Said said = said_[random_.below(static_cast<std::uint32_t>(said_.size()))];
        now_ += std::chrono::seconds{1};
        if (!end.model.initiator) end.real->tick(now_);
        const std::size_t before = end.wire->said.size();
        end.wire->deliver(said.datagram);
        EXPECT_EQ(received(*end.real), "");
        const auto answer = end.take(said.word);
        ASSERT_EQ(end.wire->said.size() - before, answer ? 1U : 0U);
        ASSERT_EQ(end.real->established(), end.model.holds.lab != 0);
        if (!answer) return;
        ASSERT_EQ(static_cast<PacketKind>(end.wire->said.back()[2]), answer->kind);
        said_.push_back({*answer, end.wire->said.back()});
    }
    // A word of one end opens at another if the model says that both hold one key, and only if the other had that key.
    void compare_keys() {
        for (const Both& from : ends_) {
            for (const Both& to : ends_) {
                if (from.model.initiator == to.model.initiator || !from.real->established()) continue;
                from.real->send(bytes_of("word"));
                to.wire->deliver(from.wire->said.back());
                const bool opened = received(*to.real) == "word";
                EXPECT_TRUE(opened || from.model.holds != to.model.holds);
                EXPECT_TRUE(!opened || std::count(to.had.begin(), to.had.end(), from.model.holds) == 1);
            }
        }
    }
    std::size_t agreed() const {
        return static_cast<std::size_t>(std::count_if(
            ends_.begin(), ends_.end(), [](const Both& end) { return end.real->established(); }));
    }

  private:
    RandomStream random_;
    SessionTime now_{std::chrono::hours{5}};
    std::vector<Both> ends_;
    std::vector<Said> said_;
};

TEST(HandshakeModel, TheRealEndsDoWhatTheModelDoes) {
    std::size_t agreed = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        Walk walk(seed);
        for (int i = 0; i < 400 && !testing::Test::HasFatalFailure(); ++i) walk.step();
        walk.compare_keys();
        agreed += walk.agreed();
    }
    EXPECT_GT(agreed, 20U);
}

}  // namespace
}  // namespace thimble
