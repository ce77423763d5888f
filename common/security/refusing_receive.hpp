// The next datagram of a wire that a judge lets through, as text; empty: none. A flood of what is refused must not hold a tick: the
// rest waits for the next one.
#pragma once

#include "common/channel.hpp"

namespace thimble {

template <class Judge>
Bytes receive_judged(Channel& wire, Judge&& judge) {
    for (int refused = 0; refused < kMostRefusedAtOnce; ++refused) {
        const Bytes datagram = wire.receive();
        if (datagram.empty()) return {};
        const Bytes text = judge(datagram);
        if (!text.empty()) return text;
    }
    return {};
}

}  // namespace thimble
