// A descriptor that a loop waits for. It becomes readable when data arrives.
#pragma once

namespace thimble {

class Listener {
  public:
    virtual int file_descriptor() const = 0;
    // From now on a loop waits for the descriptor, and calls has_mail() when it is readable.
    virtual void set_watched(bool /*watched*/) {}
    virtual void has_mail() {}

  protected:
    ~Listener() = default;
};

}  // namespace thimble
