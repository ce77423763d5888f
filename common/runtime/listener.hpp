// What a loop can wait on besides time: a descriptor that becomes readable when something has arrived.
#pragma once

namespace thimble {

class Listener {
  public:
    virtual int file_descriptor() const = 0;
    // Somebody waits for the descriptor from now on, and calls has_mail() when it has become readable.
    virtual void set_watched(bool /*watched*/) {}
    virtual void has_mail() {}

  protected:
    ~Listener() = default;
};

}  // namespace thimble
