// A session in virtual time, as a view hears it: says what the test wants and remembers what was asked of it.
#pragma once

#include <optional>
#include <vector>

#include "common/flow.hpp"
#include "common/queue_channel.hpp"
#include "tests/unit/session_time.hpp"
#include "visual_node/views/session_link.hpp"

namespace thimble {

struct HeardOrder {
    SessionTime at{};
    std::uint32_t trial = 0;  // of the header
    Order order;
};

class PlayedViewSession {
  public:
    explicit PlayedViewSession(std::uint64_t instance = 7)
        : flow_(Role::kSession, instance, {&monitors_.a}) {}

    SessionLink::Channels channels() { return {&monitors_.b, &orders_.a}; }
    void say(SessionTime now) {
        flow_.send(now, trial, monitor);
        if (replay) flow_.send(now, trial, *replay);
    }

    // All that was asked since the last call.
    std::vector<HeardOrder> heard(SessionTime now) {
        std::vector<HeardOrder> all;
        while (const Message* message = inbound_.receive(now, orders_.b)) {
            all.push_back({message->header.send_time, message->header.trial, std::get<Order>(message->body)});
        }
        return all;
    }

    Monitor monitor;
    std::uint32_t trial = 1;
    std::optional<ReplayState> replay;  // there if a recorded trial is shown

  private:
    QueuePipe monitors_, orders_;
    OutboundFlow flow_;
    InboundFlow inbound_{Role::kExperimenter};
};

// A view's model that hears this session.
template <class Model>
struct ModelBench {
    // The session speaks every 4 ms.
    void pass(int milliseconds_passed) {
        for (int i = 0; i < milliseconds_passed; i += 4) {
            now += std::chrono::milliseconds{4};
            session.say(now);
            model.update(now);
        }
    }
    // All that is asked now, not what was asked before.
    std::vector<HeardOrder> press_all(Command command) {
        (void)session.heard(now);
        model.press(now, command);
        return session.heard(now);
    }
    // The first order that `command` makes, if any.
    std::optional<Order> press(Command command) {
        const auto heard = press_all(command);
        return heard.empty() ? std::nullopt : std::optional(heard.front().order);
    }

    PlayedViewSession session;
    Model model{9, session.channels()};
    SessionTime now = at(std::chrono::milliseconds{100});
};

}  // namespace thimble
