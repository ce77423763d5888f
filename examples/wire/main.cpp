// Thimble's messages in a program of your own: through the codec, which checks them, and through the header that flatc
// made of the schema, which does not.
#include <cstdio>

#include "common/codec.hpp"
#include "messages_generated.h"

int main() {
    thimble::Encoder encoder;
    thimble::Header header;
    header.sender = thimble::Role::kMaster;
    header.sequence = 7;
    thimble::NeedleCommand command;
    command.position_needle_m = 0.021;
    const thimble::Bytes datagram = encoder.encode(header, command);

    const thimble::Decoded whole = thimble::decode(datagram);
    if (!whole.message) return 1;
    const auto& read = std::get<thimble::NeedleCommand>(whole.message->body);
    std::printf("%zu bytes, sequence %u, needle at %.3f m\n", datagram.size(), whole.message->header.sequence,
                read.position_needle_m);

    const thimble::Decoded half = thimble::decode(datagram.first(datagram.size() / 2));
    std::printf("half of it is refused: %s\n", thimble::to_string(*half.refusal));

    const auto* packet = thimble::wire::GetPacket(datagram.data());
    std::printf("by the schema: needle at %.3f m\n", packet->needle_command()->position_needle_m());
    return half.message || packet->needle_command()->position_needle_m() != read.position_needle_m ? 1 : 0;
}
