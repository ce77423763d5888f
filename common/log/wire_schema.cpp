#include "common/log/wire_schema.hpp"

#include "messages_bfbs_generated.h"

namespace thimble {

Bytes wire_schema() { return {wire::PacketBinarySchema::data(), wire::PacketBinarySchema::size()}; }

}  // namespace thimble
