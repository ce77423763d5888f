// BLAKE2b under a key, of what is said part by part; leaves nothing in memory.
#pragma once

#include <cstdint>
#include <sodium.h>
#include <span>
#include <string_view>

#include "common/network_settings.hpp"

namespace thimble {

// Keyed BLAKE2b of several parts, each of fixed length or the last one.
class KeyedHash {
  public:
    KeyedHash(std::span<const std::uint8_t> key, std::size_t size) : size_(size) {
        crypto_generichash_init(&state_, key.data(), key.size(), size);
    }
    ~KeyedHash() { sodium_memzero(&state_, sizeof state_); }
    KeyedHash(const KeyedHash&) = delete;
    KeyedHash& operator=(const KeyedHash&) = delete;

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

}  // namespace thimble
