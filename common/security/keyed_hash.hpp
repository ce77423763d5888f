// BLAKE2b under a key, of what is said part by part; leaves nothing in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <sodium.h>
#include <span>
#include <string_view>

#include <boost/core/noncopyable.hpp>

#include "common/network_settings.hpp"

namespace thimble {

// Keyed BLAKE2b of several parts, each of fixed length or the last one.
class KeyedHash : boost::noncopyable {
  public:
    KeyedHash(std::span<const std::uint8_t> key, std::size_t size) : size_(size) {
        crypto_generichash_init(&state_, key.data(), key.size(), size);
    }
    ~KeyedHash() { sodium_memzero(&state_, sizeof state_); }

    KeyedHash& add(std::span<const std::uint8_t> part) {
        crypto_generichash_update(&state_, part.data(), part.size());
        return *this;
    }
    KeyedHash& add(std::string_view words) {
        return add({reinterpret_cast<const std::uint8_t*>(words.data()), words.size()});
    }
    KeyedHash& add(Port port) {
        const auto number = static_cast<std::uint8_t>(port);
        return add({&number, 1});
    }
    void finish(std::span<std::uint8_t> out) { crypto_generichash_final(&state_, out.data(), size_); }

  private:
    std::size_t size_;
    crypto_generichash_state state_{};
};

// Numbers as they stand in datagrams: little endian, byte by byte, wherever they lie.
template <class Number>
void write_little_endian(Number number, std::uint8_t* out) {
    for (std::size_t i = 0; i < sizeof number; ++i) out[i] = static_cast<std::uint8_t>(number >> (8 * i));
}

template <class Number>
Number read_little_endian(const std::uint8_t* in) {
    Number number = 0;
    for (std::size_t i = 0; i < sizeof number; ++i) number |= static_cast<Number>(Number{in[i]} << (8 * i));
    return number;
}

}  // namespace thimble
