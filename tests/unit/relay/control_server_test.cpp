// The file of the control socket: whose it is, and when it is there.
#include "netem/relay/control_server.hpp"

#include <cstring>
#include <sys/socket.h>
#include <sys/un.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/refusal.hpp"

namespace thimble {
namespace {

int bound_socket(int type, const std::filesystem::path& path) {
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    EXPECT_LT(path.string().size(), sizeof name.sun_path) << "set TMPDIR to a shorter path";
    path.string().copy(name.sun_path, sizeof name.sun_path - 1);
    const int opened = socket(AF_UNIX, type | SOCK_CLOEXEC, 0);
    EXPECT_EQ(bind(opened, static_cast<sockaddr*>(static_cast<void*>(&name)), sizeof name), 0);
    return opened;
}

TEST(ControlServer, LeavesLiveSocketsOfOtherPrograms) {
    const TemporaryDirectory folder;
    for (const int type : {SOCK_DGRAM, SOCK_STREAM}) {
        const std::filesystem::path path = folder / std::to_string(type);
        const int other = bound_socket(type, path);
        listen(other, 1);
        EXPECT_THAT(refusal([&] { const ControlServer server(path); }, ExitCode::kNetwork),
                    testing::HasSubstr("choose another path"));
        EXPECT_TRUE(std::filesystem::exists(path));
        close(other);
    }
}

TEST(ControlServer, TakesThePlaceOfADeadOneAndLeavesNoFile) {
    const TemporaryDirectory folder;
    const std::filesystem::path path = folder / "control";
    close(bound_socket(SOCK_SEQPACKET, path));
    {
        const ControlServer server(path);
        EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
        EXPECT_THAT(refusal([&] { const ControlServer second(path); }, ExitCode::kNetwork),
                    testing::HasSubstr("choose another path"));
        EXPECT_TRUE(std::filesystem::is_socket(path));
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace thimble
