#include "session/launch/node_starter.hpp"

#include "common/runtime/wall_clock.hpp"

namespace thimble {

std::optional<int> wait_for_end(RunningNode& node, Duration limit) {
    const SessionTime deadline = wall_now() + limit;
    while (!node.poll() && wall_now() < deadline) wall_sleep(std::chrono::milliseconds{5});
    return node.poll();
}

}  // namespace thimble
