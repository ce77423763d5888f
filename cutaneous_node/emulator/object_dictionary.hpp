// The object dictionary of an emulated drive: values of up to four bytes, what may be written, and SDO on top of it.
#pragma once

#include <map>

#include "cutaneous_node/can/canopen.hpp"

namespace thimble {

class ObjectDictionary {
  public:
    // A CiA 402 drive in the state after its reset.
    explicit ObjectDictionary(std::uint8_t node);

    // The drive's own view: the object exists.
    std::uint32_t get(ObjectKey key) const;
    void set(ObjectKey key, std::uint32_t value);
    bool has(ObjectKey key) const { return entries_.count(key) > 0; }

    // The answer of a server.
    Sdo answer(const Sdo& request);

  private:
    struct Entry {
        std::uint32_t value = 0;
        std::uint8_t bytes = 4;
        bool writable = false;
    };
    void add_mapping(std::uint16_t communication, std::uint16_t mapping, std::uint32_t id);
    std::uint32_t write(const Sdo& request);
    std::uint32_t check_mapping(const Sdo& request) const;

    std::map<ObjectKey, Entry> entries_;
};

// The content of a PDO with this mapping (0x1600, 0x1A00).
CanFrame pack_pdo(const ObjectDictionary& dictionary, std::uint16_t mapping, std::uint32_t id);
std::uint8_t pdo_bytes(const ObjectDictionary& dictionary, std::uint16_t mapping);
// `frame` has that many bytes at least.
void unpack_pdo(ObjectDictionary& dictionary, std::uint16_t mapping, const CanFrame& frame);

}  // namespace thimble
