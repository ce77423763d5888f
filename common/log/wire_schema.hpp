// messages.fbs as FlatBuffers writes schemas down (reflection.fbs): made by flatc at build time, and part of every log.
#pragma once

#include "common/channel.hpp"

namespace thimble {

inline constexpr const char* kWireSchemaName = "thimble.wire.Packet";

Bytes wire_schema();

}  // namespace thimble
