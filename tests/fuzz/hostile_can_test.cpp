// The same seeded nonsense for both ends of the CAN bus, in every build.
#include <vector>

#include <gtest/gtest.h>

#include "common/random.hpp"
#include "tests/fuzz/can_check.hpp"

namespace thimble {
namespace {

TEST(HostileCan, NonsenseNeitherCrashesNorPresses) {
    RandomStream stream({1, 0, 0, 0, Purpose::kInstance});
    for (int i = 0; i < 300; ++i) {
        std::vector<std::uint8_t> bytes(stream() % 400);
        for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(stream());
        if (i % 2 == 0 && bytes.size() > 5) {  // deeper into the datagrams
            bytes[0] = 2;
            bytes[1] = bytes[3] = 0;
        }
        const char* flaw = flaw_of_bus(bytes);
        ASSERT_EQ(flaw, nullptr) << flaw << ", round " << i;
    }
}

}  // namespace
}  // namespace thimble
