// The flows behind a relay, as in a NAT: each client address at each inlet is a flow of its own. Numbers and times
// only, no sockets.
#pragma once

#include <cassert>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "common/runtime/udp_socket.hpp"
#include "common/time.hpp"

namespace thimble {

struct FlowName {
    std::uint32_t inlet = 0;  // which --listen
    UdpAddress client;
    bool operator==(const FlowName&) const = default;
};

class FlowTable {
  public:
    // Places are numbered from 0 to `most` - 1 and used again when a flow has gone.
    explicit FlowTable(std::size_t most, std::size_t inlets) : flows_(most), next_number_(inlets, 0) {
        places_.reserve(most);
        idle_.reserve(most);
        for (std::size_t place = most; place > 0; --place)
            free_.push_back(static_cast<std::uint32_t>(place - 1));
    }

    struct Found {
        std::uint32_t place;
        bool fresh;  // the caller has to open it
    };
    // The flow of this client, opened if need be; nothing if the table is full. Counts as a sign of life.
    std::optional<Found> find(const FlowName& name, SessionTime now) {
        assert(name.inlet < next_number_.size());
        if (const auto known = places_.find(name); known != places_.end()) {
            alive(known->second, now);
            return Found{known->second, false};
        }
        if (free_.empty()) return std::nullopt;
        const std::uint32_t place = free_.back();
        free_.pop_back();
        flows_[place] = {name, next_number_[name.inlet]++, now, true};
        places_.emplace(name, place);
        ++opened_;
        return Found{place, true};
    }

    void alive(std::uint32_t place, SessionTime now) { flows_[place].last = now; }
    void close(std::uint32_t place) {
        assert(flows_[place].open);
        places_.erase(flows_[place].name);
        flows_[place].open = false;
        free_.push_back(place);
    }

    // Takes back what find() has just opened: a client that got no socket is no flow.
    void refuse(std::uint32_t place) {
        close(place);
        --opened_;
        --next_number_[flows_[place].name.inlet];
    }

    // Open places that gave no sign of life since `before`, to be judged by the caller.
    std::span<const std::uint32_t> idle_since(SessionTime before) {
        idle_.clear();
        for (const auto& [_, place] : places_) {
            if (flows_[place].last < before) idle_.push_back(place);
        }
        return idle_;
    }

    const FlowName& name(std::uint32_t place) const { return flows_[place].name; }
    // The n-th flow of its inlet since the start, from 0: names its random fates, whatever place it has.
    std::uint32_t number(std::uint32_t place) const { return flows_[place].number; }
    bool open(std::uint32_t place) const { return flows_[place].open; }
    std::size_t size() const { return places_.size(); }
    std::uint64_t opened() const { return opened_; }

  private:
    struct Flow {
        FlowName name;
        std::uint32_t number = 0;
        SessionTime last{};
        bool open = false;
    };
    struct Hash {
        std::size_t operator()(const FlowName& name) const { return name.client.hash() + name.inlet; }
    };

    std::unordered_map<FlowName, std::uint32_t, Hash> places_;
    std::vector<Flow> flows_;
    std::vector<std::uint32_t> free_;  // the lowest place last
    std::vector<std::uint32_t> next_number_;
    std::vector<std::uint32_t> idle_;
    std::uint64_t opened_ = 0;
};

}  // namespace thimble
