#include "netem/relay/flow_table.hpp"

#include <cassert>

namespace thimble {

FlowTable::FlowTable(std::size_t most, std::size_t inlets) : flows_(most), next_number_(inlets, 0) {
    places_.reserve(most);
    idle_.reserve(most);
    for (std::size_t place = most; place > 0; --place) free_.push_back(static_cast<std::uint32_t>(place - 1));
}

std::optional<FlowTable::Found> FlowTable::find(const FlowName& name, SessionTime now) {
    assert(name.inlet < next_number_.size());
    if (const auto known = places_.find(key_of(name)); known != places_.end()) {
        alive(known->second, now);
        return Found{known->second, false};
    }
    if (free_.empty()) return std::nullopt;
    const std::uint32_t place = free_.back();
    free_.pop_back();
    flows_[place] = {name, next_number_[name.inlet]++, now, true};
    places_.emplace(key_of(name), place);
    ++opened_;
    return Found{place, true};
}

void FlowTable::close(std::uint32_t place) {
    assert(flows_[place].open);
    places_.erase(key_of(flows_[place].name));
    flows_[place].open = false;
    free_.push_back(place);
}

std::span<const std::uint32_t> FlowTable::idle_since(SessionTime before) {
    idle_.clear();
    for (const auto& [_, place] : places_) {
        if (flows_[place].last < before) idle_.push_back(place);
    }
    return idle_;
}

}  // namespace thimble
