// Records the messages that a process sends and receives. If recording fails, the trial ends.
#pragma once

#include <string_view>

namespace thimble {

class Recorder {
  public:
    // Empty while it works; else what cannot be written, why, and what to do. Cheap enough for every tick.
    virtual std::string_view fault() const = 0;

  protected:
    ~Recorder() = default;
};

}  // namespace thimble
