// The names of a session's flows in a log (docs/log.md): one topic from a sender to a receiver, the same at both ends and on both sides of the relay.
#pragma once

#include "common/channel.hpp"
#include "common/network_settings.hpp"

namespace thimble {

// "/master/needle_command" for what arrives at the relay's or at slave_sim's port for it.
const char* log_topic(Port arrives_at);

// messages.fbs as FlatBuffers writes schemas down (reflection.fbs): made by flatc at build time, and part of every log.

inline constexpr const char* kWireSchemaName = "thimble.wire.Packet";

Bytes wire_schema();

}  // namespace thimble
