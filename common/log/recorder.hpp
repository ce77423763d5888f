// Writes down the messages that a process sends and receives. A trial that cannot be written down ends.
#pragma once

#include <string_view>

namespace thimble {

class Recorder {
  public:
    // Empty while it works; else what cannot be written, why, and what to do. May be asked at every tick.
    virtual std::string_view fault() const = 0;

  protected:
    ~Recorder() = default;
};

}  // namespace thimble
