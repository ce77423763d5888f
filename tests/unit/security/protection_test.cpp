// When datagrams may go unprotected.
#include "common/runtime/protection.hpp"

#include <array>
#include <cstdlib>
#include <new>
#include <sys/prctl.h>
#include <sys/resource.h>

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
    expect_usage([] { require_protection(network("[network]\nhost_slave_sim = 'nowhere.invalid'\n")); },
                 "nowhere.invalid");  // a name server that is silent now may answer when the socket is opened
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

// In a child, because it cannot be taken back.
TEST(Protection, AProgramWithAKeyLeavesNoCoreDump) {
    const auto end = [] {
        rlimit cores{1, 1};
        getrlimit(RLIMIT_CORE, &cores);
        std::_Exit(cores.rlim_cur == 0 && cores.rlim_max == 0 && prctl(PR_GET_DUMPABLE) == 0 ? 0 : 1);
    };
    const auto keep = [&end] {
        hide_memory();
        end();
    };
    EXPECT_EXIT(keep(), testing::ExitedWithCode(0), "");
    const auto with_key = [&end] {
        try {
            make_security(network("[security]\nmode = 'lab-key'\nkey_file = '/nowhere/lab.key'\n").security);
        } catch (const Error&) {  // hidden before the key is read
        }
        end();
    };
    EXPECT_EXIT(with_key(), testing::ExitedWithCode(0), "");
}

TEST(Protection, AKeyIsWipedWhenItGoes) {
    alignas(SecretKey) std::array<std::uint8_t, sizeof(SecretKey)> place{};
    auto* key = new (place.data()) SecretKey;
    key->bytes.fill(0xA5);
    // Read as volatile memory, so that the compiler cannot know its content.
    const volatile std::uint8_t* bytes = place.data();
    ASSERT_EQ(bytes[7], 0xA5);
    key->~SecretKey();
    for (std::size_t i = 0; i < place.size(); ++i) ASSERT_EQ(bytes[i], 0) << i;
}

}  // namespace
}  // namespace thimble
