#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/runtime/udp_socket.hpp"

namespace thimble {
namespace {

TEST(UdpAddress, ReadsPortAndHost) {
    EXPECT_EQ(to_string(read_udp_address("9000", "--listen")), "0.0.0.0:9000");
    EXPECT_EQ(to_string(read_udp_address("127.0.0.1:65535", "--to")), "127.0.0.1:65535");
    EXPECT_EQ(to_string(read_udp_address("localhost:1", "--to")), "127.0.0.1:1");
}

TEST(UdpAddress, RefusesOthersByTheOptionsName) {
    for (const char* text : {"", "host:", "host:65536", "host:-1", "9000x", "a:b", "host: 1"}) {
        try {
            read_udp_address(text, "--to");
            FAIL() << text;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::kUsage);
            EXPECT_NE(std::string(error.what()).find("--to"), std::string::npos);
        }
    }
}

}  // namespace
}  // namespace thimble
