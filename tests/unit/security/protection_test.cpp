// When datagrams may go unprotected.
#include "common/runtime/protection.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/runtime/sockets.hpp"

namespace thimble {
namespace {

NetworkSettings network(const std::string& text) {
    const ConfigFile file = ConfigFile::parse(text, "session.toml");
    NetworkSettings settings = read_network_settings(file);
    file.finish();
    return settings;
}

void expect_usage(const std::function<void()>& what, const std::string& words) {
    try {
        what();
        ADD_FAILURE() << "allowed: " << words;
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kUsage) << error.what();
        EXPECT_THAT(error.what(), testing::HasSubstr(words));
    }
}

constexpr const char* kElsewhere = "[network]\nhost_slave_sim = '192.0.2.1'\n";

TEST(Protection, IsOptionalOnThisMachineAlone) {
    EXPECT_NO_THROW(require_protection(network("")));
    EXPECT_NO_THROW(require_protection(network("[network]\nhost_slave_sim = '127.0.0.2'\n")));
    EXPECT_NO_THROW(require_protection(network("[network]\nhost_slave_sim = 'nowhere.invalid'\n")));
    expect_usage([] { Sockets{network(kElsewhere)}; }, "192.0.2.1");
    expect_usage([] { require_protection(network("[network]\nhost_slave_sim = '0.0.0.0'\n")); },
                 "thimble keygen");
}

TEST(Protection, IsDoneWithoutWhenThatIsSaidTwice) {
    const std::string elsewhere = kElsewhere;
    expect_usage([&] { require_protection(network(elsewhere + "[security]\nmode = 'none'\n")); },
                 "mode = \"lab-key\"");
    expect_usage(
        [&] { require_protection(network(elsewhere + "[security]\nallow_unprotected_network = true\n")); },
        "allow_unprotected_network = true");
    EXPECT_NO_THROW(require_protection(
        network(elsewhere + "[security]\nmode = 'none'\nallow_unprotected_network = true\n")));
    EXPECT_NO_THROW(require_protection(network(elsewhere + "[security]\nmode = 'lab-key'\n")));
}

TEST(Protection, SettingsAreReadStrictly) {
    expect_usage([] { network("[security]\nmode = 'tls'\n"); }, "lab-key");
    expect_usage([] { network("[security]\nkey = 'x'\n"); }, "key");
    expect_usage([] { network("[security]\nkey_file = 'lab.key'\n"); }, "without mode");
    EXPECT_EQ(network("[security]\nmode = 'lab-key'\nkey_file = 'lab.key'\n").security.key_file, "lab.key");
}

TEST(Protection, ADeviceElsewhereIsSpokenToOnPurposeOnly) {
    Sockets sockets{NetworkSettings{}};
    expect_usage([&] { sockets.device({"127.0.0.1", 0}, {"192.0.2.1", 20000}); }, "192.0.2.1");
    EXPECT_NO_THROW(sockets.device({"127.0.0.1", 0}, {"127.0.0.1", 20000}));
    NetworkSettings allowed;
    allowed.security.allow_unprotected_network = true;
    EXPECT_NO_THROW(Sockets{allowed}.device({"127.0.0.1", 0}, {"192.0.2.1", 20000}));
}

TEST(Protection, WithoutItsKeyAProgramDoesNotStart) {
    expect_usage([] { Sockets{network("[security]\nmode = 'lab-key'\nkey_file = '/nowhere/lab.key'\n")}; },
                 "/nowhere/lab.key");
}

}  // namespace
}  // namespace thimble
