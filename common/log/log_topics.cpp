#include "common/log/log_topics.hpp"

#include <array>

#include "messages_bfbs_generated.h"

namespace thimble {

namespace {

// In the order of Port.
constexpr std::array<const char*, kPortCount> kTopics{
    "/master/heartbeats",
    "/slave_sim/heartbeats",
    "/cutaneous/heartbeats",
    "/visual/heartbeats",
    "/netem/heartbeats",
    "/slave_sim/record",
    "/session/orders/master",
    "/session/orders/slave_sim",
    "/session/orders/cutaneous",
    "/session/orders/visual",
    "/session/orders/netem",
    "/slave_sim/force_feedback/master",
    "/cutaneous/percept",
    "/visual/percept",
    "/master/needle_command",
    "/slave_sim/force_feedback/cutaneous",
    "/slave_sim/force_feedback/visual",
    "/slave_sim/beep",
    "/master/needle_command",
    "/slave_sim/force_feedback/master",
    "/slave_sim/force_feedback/cutaneous",
    "/slave_sim/force_feedback/visual",
    "/visual/hand_input",
    "/experimenter/order",
    "/session/monitor/experimenter",
    "/visual/order",
    "/session/monitor/player",
    "/stop/session",
    "/stop/master",
    "/stop/slave_sim",
    "/stop/cutaneous",
    "/stop/visual",
    "/stop/netem",
};

}  // namespace

const char* log_topic(Port arrives_at) { return kTopics.at(static_cast<std::size_t>(arrives_at)); }

Bytes wire_schema() { return {wire::PacketBinarySchema::data(), wire::PacketBinarySchema::size()}; }

}  // namespace thimble
