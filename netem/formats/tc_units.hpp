// Times, shares, rates and sizes as tc writes and reads them (iproute2, man tc "PARAMETERS"). Both ways are exact:
// what is printed here is read back as the same value.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "common/time.hpp"

namespace thimble {

// "50ms", "0.8s", "100usec", "5ns". A bare number is in units of `bare`: microseconds for delays, nanoseconds for
// slots. Nothing for what is no time, negative, or above an hour.
std::optional<Duration> parse_tc_time(std::string_view word, Duration bare);
// "0.5%" or "0.5": 0.005. Nothing outside of 0 to 100.
std::optional<double> parse_tc_share(std::string_view word);
// Bits per second: "1mbit", "125kbps" (bytes per second), "1mibit", a bare number in bit/s.
std::optional<double> parse_tc_rate(std::string_view word);
// Bytes: "64k" is 65536, "8kbit" 1024, a bare number bytes.
std::optional<std::size_t> parse_tc_size(std::string_view word);

std::string print_tc_time(Duration time);
std::string print_tc_share(double share);
std::string print_tc_rate(double bits_per_s);

}  // namespace thimble
