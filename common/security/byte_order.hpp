// Numbers as they stand in datagrams: little endian, byte by byte, wherever they lie.
#pragma once

#include <cstddef>
#include <cstdint>

namespace thimble {

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
