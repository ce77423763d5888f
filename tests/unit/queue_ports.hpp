// Ports of one process for its unit tests: a queue behind each, whose far end is the test's.
#pragma once

#include <map>

#include "common/ports.hpp"
#include "common/queue_channel.hpp"

namespace thimble {

class QueuePorts final : public Ports {
  public:
    Channel* between(Port local, Port /*remote*/) override { return &pipes_[local].a; }
    Channel* inlet(Port local) override { return &pipes_[local].a; }
    Channel* outlet(Port remote) override { return &pipes_[remote].a; }
    Channel* far_end(Port port) { return &pipes_[port].b; }

  private:
    std::map<Port, QueuePipe> pipes_;
};

}  // namespace thimble
