// Carries out the orders of a view, each of them once. A view repeats an order until the Monitor shows it, and names in the header
// the trial for which it was asked: a Start or an EndTrial that comes late is not one for the next trial.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/flow.hpp"

namespace thimble {

class OrderHandler {
  public:
    virtual ~OrderHandler() = default;
    OrderHandler() = default;
    OrderHandler(const OrderHandler&) = delete;
    OrderHandler& operator=(const OrderHandler&) = delete;

    // Why it cannot be obeyed; none: it is (and would be, unchanged, the second time).
    virtual std::optional<Refusal> obey(SessionTime now, const Order& order) = 0;
};

class OrderTaker {
  public:
    // A Repeat or an Exclude that comes again within this time is the same one, said again because UDP loses.
    static constexpr Duration kSameRequest = std::chrono::seconds{1};

    // Both outlive the taker.
    OrderTaker(Channel& in, OrderHandler& handler) : in_(&in), handler_(&handler) {}

    // `trial`: the newest, on the wire.
    void tick(SessionTime now, std::uint32_t trial);
    const FlowCounters& counters() const { return flow_.counters(); }

  private:
    struct Request {
        std::uint32_t trial = 0;
        SessionTime last{};
        bool said = false;
    };
    std::optional<Refusal> judge(SessionTime now, std::uint32_t asked_for, std::uint32_t trial,
                                 const Order& order);
    bool said_again(SessionTime now, Request& request, std::uint32_t trial);

    Channel* in_;
    OrderHandler* handler_;
    InboundFlow flow_{Role::kExperimenter};
    Request repeat_, exclude_;
};

}  // namespace thimble
