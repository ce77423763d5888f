// Valid messages to start from, and the promises of every message that decode() lets through.
#pragma once

#include <vector>

#include "common/messages.hpp"

namespace thimble {

// One message of each kind, no field at its default.
std::vector<Message> sample_messages();

// Every number finite and inside the range docs/protocol.md gives it, every enum one of its values. Written
// again here, from the page and not from the codec.
bool plausible(Message message);

// A double of a message, and its range by the page.
struct LegalNumber {
    double* value;
    double low, high;
};
std::vector<LegalNumber> numbers_of(Body& body);

// The reason why an accepted message is no good (implausible, or changed by encoding and decoding it again),
// or null.
const char* flaw_of(const Message& accepted);

}  // namespace thimble
