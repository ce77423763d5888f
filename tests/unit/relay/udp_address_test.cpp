#include "netem/relay/udp_address.hpp"

#include <arpa/inet.h>

#include <gtest/gtest.h>

#include "common/error.hpp"

namespace thimble {
namespace {

TEST(UdpAddress, ReadsPortAndHost) {
    EXPECT_EQ(to_string(read_udp_address("9000", "--listen")), "0.0.0.0:9000");
    EXPECT_EQ(to_string(read_udp_address("127.0.0.1:65535", "--to")), "127.0.0.1:65535");
    EXPECT_EQ(to_string(read_udp_address("localhost:1", "--to")), "127.0.0.1:1");
}

class BadAddress : public testing::TestWithParam<const char*> {};

TEST_P(BadAddress, IsRefusedByName) {
    try {
        read_udp_address(GetParam(), "--to");
        FAIL() << GetParam();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kUsage);
        EXPECT_NE(std::string(error.what()).find("--to"), std::string::npos);
    }
}

INSTANTIATE_TEST_SUITE_P(Words, BadAddress,
                         testing::Values("", "host:", "host:65536", "host:-1", "9000x", "a:b", "host: 1"));

}  // namespace
}  // namespace thimble
