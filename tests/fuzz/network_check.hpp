// Any bytes as a file or as words that describe a network: refused as what they are, or good. The first byte chooses
// the reader, so that one fuzzer has them all. One check for the fuzzer and for the test of every build.
#pragma once

#include <string_view>

#include "tests/fuzz/verdict.hpp"

namespace thimble {

// '0' tc's words, '1' .dist, '2' trace (CSV), '3' mahimahi, '4' pcap, '5' irtt, '6' ping, '7' profile.
inline constexpr unsigned kNetworkReaders = 8;

Verdict check_network_file(std::string_view bytes);

}  // namespace thimble
