// A session as OpenIGTLink messages (version 1 of the protocol, by Debian's library): http://openigtlink.org/protocols/.
//
//   TRANSFORM "Needle", "Surface"   along z, positive into the tissue, in mm as OpenIGTLink has it
//   SENSOR    "Force"               total, tissue, fixture, at the handle (positive pushes the hand out); N
//   STRING    "State"               trial, modality, phase of the tissue, beep, for people
//   STATUS    "Thimble"             running, waiting, or why a trial has ended
#pragma once

#include <cstdint>
#include <memory>

#include "common/channel.hpp"
#include "common/messages.hpp"

namespace thimble {

class IgtlText {
  public:
    IgtlText();
    ~IgtlText();
    IgtlText(const IgtlText&) = delete;
    IgtlText& operator=(const IgtlText&) = delete;

    // Each is one message; `date_ns` since 1970. Valid until the next call of the same function.
    Bytes needle(std::int64_t date_ns, const Monitor& monitor);
    Bytes surface(std::int64_t date_ns, const Monitor& monitor);
    Bytes force(std::int64_t date_ns, const Monitor& monitor);
    Bytes state(std::int64_t date_ns, std::uint32_t trial, const Monitor& monitor);
    // `silent`: nobody has spoken for a while.
    Bytes status(std::int64_t date_ns, const Monitor& monitor, bool silent);

  private:
    struct Messages;
    std::unique_ptr<Messages> messages_;
};

}  // namespace thimble
