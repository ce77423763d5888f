#include "study/swarm/swarm_case.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace thimble {
namespace {

constexpr std::uint32_t kMostFaults = 5;
constexpr double kSealedShare = 0.04;
constexpr double kEarlyShare = 0.15;  // of faults that hold from the start: so programs come up in any order
// A trial of the swarm touches the fixture after 2 to 3 s.
constexpr double kLatest_s = 5;

// Where [netem] corrupts, too. On other wires the checksum of UDP finds a flipped bit.
constexpr std::array kRelayed{Port::kMasterForce, Port::kCutaneousForce, Port::kVisualForce,
                              Port::kSlaveNeedle};

template <class List>
const auto& any_of_list(const List& list, RandomStream& draw) {
    return list[draw.below(static_cast<std::uint32_t>(list.size()))];
}

SwarmFault draw_fault(RandomStream& draw, bool sealed) {
    SwarmFault fault;
    fault.kind = static_cast<FaultKind>(draw.below(static_cast<std::uint32_t>(FaultKind::kCount)));
    fault.role = any_of_list(kSwarmPrograms, draw);
    fault.port = any_of_list(kEveryPort, draw);
    fault.at = SessionTime{from_seconds(draw.uniform() < kEarlyShare ? 0 : kLatest_s * draw.uniform())};
    fault.length = from_seconds(draw.uniform() < 0.5 ? 0.15 * draw.uniform() : 2.5 * draw.uniform());
    fault.value = draw.uniform();
    if (fault.kind == FaultKind::kCorrupt) fault.port = any_of_list(kRelayed, draw);
    // Only nodes start anew, and without the keys of a session that runs they take no part in it.
    if (fault.kind == FaultKind::kRestart && (sealed || fault.role == Role::kSession))
        fault.kind = FaultKind::kStall;
    return fault;
}

std::string place_of(const SwarmFault& fault) {
    if (of_wire(fault.kind)) return fmt::format(", port {}", static_cast<int>(fault.port));
    if (of_program(fault.kind) || fault.kind == FaultKind::kStop)
        return fmt::format(", {}", to_string(fault.role));
    return "";
}

}  // namespace

std::string fault_text(const SwarmFault& fault) {
    return fmt::format("{}{}, at {:.4f} s for {:.4f} s, value {:.4f}",
                       kFaultNames[static_cast<std::size_t>(fault.kind)], place_of(fault),
                       to_seconds(fault.at.time_since_epoch()), to_seconds(fault.length), fault.value);
}

SwarmCase draw_case(const std::vector<KeyDeclaration>& keys, std::uint64_t seed) {
    RandomStream draw({seed, 0, 0, 0, Purpose::kParameter});
    SwarmCase one;
    one.seed = seed;
    one.sealed = draw.uniform() < kSealedShare;
    one.trials = draw.uniform() < 0.3 ? 2 : 1;
    one.keys = draw_keys(keys, draw);
    for (std::uint32_t left = draw.below(kMostFaults); left-- > 0;)
        one.faults.push_back(draw_fault(draw, one.sealed));
    return one;
}

std::string repeat_command(const SwarmCase& one) {
    const std::string plugin = one.plugin.empty() ? "" : " --plugin " + one.plugin.string();
    return fmt::format("thimble swarm --seed {}{}", one.seed, plugin);
}

std::string case_text(const SwarmCase& one) {
    std::string text = fmt::format("# {}: trials {}{}\n", repeat_command(one), one.trials,
                                   one.sealed ? ", under a lab key" : "");
    for (const SwarmFault& fault : one.faults) text += fmt::format("# fault: {}\n", fault_text(fault));
    return text + keys_text(one.keys);
}

}  // namespace thimble
