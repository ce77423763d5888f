// When datagrams may go unprotected.
#include "common/runtime/protection.hpp"

#include <array>
#include <barrier>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <new>
#include <sstream>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/runtime/sockets.hpp"
#include "common/security/lab_key_file.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/security/security_rig.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

NetworkSettings network(const std::string& text) {
    const ConfigFile file = ConfigFile::parse(text, "session.toml");
    NetworkSettings settings = read_network_settings(file);
    file.finish();
    return settings;
}

template <class What>
void expect_usage(const What& what, const std::string& words) {
    EXPECT_THAT(refusal(what, ExitCode::kUsage), testing::HasSubstr(words));
}

const std::string kElsewhere = "[network]\nhost_slave_sim = '192.0.2.1'\n";
const std::string kOpen = "[security]\nmode = 'none'\nallow_unprotected_network = true\n";
const std::string kWithLabKey = "[security]\nmode = 'lab-key'\n";

TEST(Protection, NeedsALabKeyBetweenMachines) {
    EXPECT_NO_THROW(require_protection(network("")));
    EXPECT_NO_THROW(require_protection(network("[network]\nhost_slave_sim = '127.0.0.2'\n")));
    expect_usage([] { require_protection(network("[network]\nhost_slave_sim = 'nowhere.invalid'\n")); },
                 "nowhere.invalid");  // a name server that is silent now may answer when the socket is opened
    expect_usage([] { Sockets{network(kElsewhere)}; }, "192.0.2.1");
    expect_usage([] { require_protection(network("[network]\nhost_slave_sim = '0.0.0.0'\n")); },
                 "thimble keygen");
}

TEST(Protection, IsDoneWithoutWhenThatIsSaidTwice) {
    expect_usage([] { require_protection(network(kElsewhere + "[security]\nmode = 'none'\n")); },
                 "mode = \"lab-key\"");
    expect_usage(
        [] { require_protection(network(kElsewhere + "[security]\nallow_unprotected_network = true\n")); },
        "allow_unprotected_network = true");
    EXPECT_NO_THROW(require_protection(network(kElsewhere + kOpen)));
    EXPECT_NO_THROW(require_protection(network(kElsewhere + kWithLabKey)));
}

std::string warning_of(const std::string& text) {
    std::ostringstream said;
    const auto before = spdlog::default_logger();
    spdlog::set_default_logger(
        std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(said)));
    warn_if_unprotected(network(text));
    spdlog::set_default_logger(before);
    return said.str();
}

TEST(Protection, IsMissedAloudWhereverItIsSwitchedOff) {
    EXPECT_EQ(warning_of(""), "");
    EXPECT_EQ(warning_of("[network]\nhost_slave_sim = '127.0.0.2'\n"), "");
    EXPECT_THAT(warning_of("[security]\nmode = 'none'\n"), HasSubstr("anybody on this machine can move"));
    EXPECT_EQ(warning_of(kElsewhere + kWithLabKey), "");
    EXPECT_THAT(warning_of(kElsewhere + kOpen), HasSubstr("not protected"));
    EXPECT_THAT(warning_of("[network]\nhost_slave_sim = '0.0.0.0'\n" + kOpen), HasSubstr("thimble keygen"));
}

TEST(Protection, ARealHandleTakesNoForceFromAnOpenNetwork) {
    expect_usage([] { require_protection_of_handle(network(kElsewhere + kOpen)); }, "192.0.2.1");
    EXPECT_NO_THROW(require_protection_of_handle(network(kOpen)));
    EXPECT_NO_THROW(require_protection_of_handle(network(kElsewhere + kWithLabKey)));
}

TEST(Protection, TwoRigsAreTwoNames) {
    const std::string here = network("").rig();
    EXPECT_NE(here, network("[network]\nhost_slave_sim = '127.0.0.2'\n").rig());
    EXPECT_NE(here, network("[network]\nbase_port = 28000\n").rig());
    const std::string named = "[security]\nrig = 'left'\n";
    EXPECT_NE(here, network(named).rig());
    EXPECT_NE(network(named).rig(), network(named + "[network]\nbase_port = 28000\n").rig());
    EXPECT_EQ(network(named).rig(), network(named + "[network]\nhost_netem = '127.0.0.2'\n").rig());
}

TEST(Protection, SettingsAreReadStrictly) {
    expect_usage([] { network("[security]\nmode = 'tls'\n"); }, "lab-key");
    expect_usage([] { network("[security]\nkey = 'x'\n"); }, "key");
    expect_usage([] { network("[security]\nkey_file = 'lab.key'\n"); }, "has an effect with mode");
    EXPECT_EQ(network("[security]\nmode = 'lab-key'\nkey_file = 'lab.key'\n").security.key_file, "lab.key");
}

TEST(Protection, ADeviceElsewhereIsSpokenToOnPurposeOnly) {
    NetworkSettings allowed;
    allowed.security.mode = SecurityMode::kNone;
    Sockets sockets{allowed};
    expect_usage([&] { sockets.device({"127.0.0.1", 0}, {"192.0.2.1", 20000}); }, "192.0.2.1");
    EXPECT_NO_THROW(sockets.device({"127.0.0.1", 0}, {"127.0.0.1", 20000}));
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
            make_security(network("[security]\nmode = 'lab-key'\nkey_file = '/nowhere/lab.key'\n"));
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

// The lab key as a file: its owner's alone, never overwritten.
namespace fs = std::filesystem;

class LabKeyFile : public testing::Test {
  protected:
    static void expect_refused(const fs::path& path, ExitCode code, const std::string& words) {
        EXPECT_THAT(refusal([&] { read_lab_key(path); }, code),
                    testing::AllOf(HasSubstr(words), HasSubstr(path.string())));
    }
    fs::path write(const std::string& text) const {
        const fs::path path = folder_ / "written.key";
        std::ofstream(path) << text;
        chmod(path.c_str(), 0600);
        return path;
    }

    TemporaryDirectory folder_;
};

TEST_F(LabKeyFile, IsReadBackAsItWasMade) {
    const fs::path path = folder_ / "new/folder/lab.key";
    create_lab_key(path, [](auto bytes) { std::fill(bytes.begin(), bytes.end(), std::uint8_t{0xA5}); });
    struct stat found {};
    ASSERT_EQ(stat(path.c_str(), &found), 0);
    EXPECT_EQ(found.st_mode & 07777U, 0600U);
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    EXPECT_EQ(line, "thimble-lab-key-1 paWlpaWlpaWlpaWlpaWlpaWlpaWlpaWlpaWlpaWlpaU=");
    EXPECT_TRUE(same_bytes(read_lab_key(path).bytes(), test_lab_key(0xA5)->bytes()));
    chmod(path.c_str(), 0400);
    EXPECT_NO_THROW(read_lab_key(path));
}

TEST_F(LabKeyFile, IsNeverOverwritten) {
    const fs::path path = write("something");
    EXPECT_THAT(refusal([&] { create_lab_key(path, seeded_bytes(1)); }, ExitCode::kUsage),
                HasSubstr(path.string()));
    EXPECT_EQ(fs::file_size(path), 9U);
    fs::create_symlink("nowhere", folder_ / "link");
    EXPECT_THROW(create_lab_key(folder_ / "link", seeded_bytes(1)), Error);
    EXPECT_FALSE(fs::exists(folder_ / "nowhere"));
}

TEST_F(LabKeyFile, IsRefusedWhereOthersMayReadIt) {
    const fs::path path = folder_ / "lab.key";
    create_lab_key(path, seeded_bytes(1));
    for (const mode_t mode : {0640U, 0604U, 0660U, 0644U, 0700U, 0602U, 04600U}) {
        chmod(path.c_str(), mode);
        expect_refused(path, ExitCode::kUsage, "chmod 600");
    }
    if (geteuid() != 0 || chown(path.c_str(), 12345, 12345) != 0) return;  // only root can give a file away
    chmod(path.c_str(), 0600);
    expect_refused(path, ExitCode::kUsage, "belongs to another user");
}

// systemd's: root's, readable through an access list, which shows as the group's right.
TEST_F(LabKeyFile, IsTakenFromAServicesCredentials) {
    const fs::path path = folder_ / "lab.key";
    create_lab_key(path, seeded_bytes(1));
    setenv("CREDENTIALS_DIRECTORY", folder_.path().c_str(), 1);
    EXPECT_EQ(lab_key_file("/somewhere/else"), path);
    EXPECT_EQ(new_lab_key_file("/somewhere/else"), "/somewhere/else");
    if (geteuid() == 0) {
        chmod(path.c_str(), 0440);
        EXPECT_NO_THROW(read_lab_key(path));
        chmod(path.c_str(), 0444);
        expect_refused(path, ExitCode::kUsage, "chmod 600");
    }
    setenv("CREDENTIALS_DIRECTORY", "/nowhere", 1);
    chmod(path.c_str(), 0440);
    EXPECT_EQ(lab_key_file("/somewhere/else"), "/somewhere/else");
    expect_refused(path, ExitCode::kUsage, "chmod 600");
    unsetenv("CREDENTIALS_DIRECTORY");
}

TEST_F(LabKeyFile, ThatIsNoneIsNamed) {
    expect_refused(folder_ / "absent", ExitCode::kUsage, "thimble keygen");
    expect_refused(folder_.path(), ExitCode::kUsage, "is not a file");
    const std::string good = "thimble-lab-key-1 paWlpaWlpaWlpaWlpaWlpaWlpaWlpaWlpaWlpaWlpaU=\n";
    EXPECT_NO_THROW(read_lab_key(write(good)));
    for (const std::string& text :
         {std::string(), good.substr(1), good.substr(0, good.size() - 1), good + "\n",
          "thimble-lab-key-2" + good.substr(17), good.substr(0, 20) + "!" + good.substr(21),
          std::string(good.size(), '\0')}) {
        expect_refused(write(text), ExitCode::kData, "no lab key");
    }
}

// Made by the first program that needs it.
class UserKeyFile : public testing::Test {
  protected:
    void SetUp() override { setenv("XDG_STATE_HOME", folder_.path().c_str(), 1); }
    void TearDown() override {
        if (before_.empty()) unsetenv("XDG_STATE_HOME");
        if (!before_.empty()) setenv("XDG_STATE_HOME", before_.c_str(), 1);
    }
    static std::string refused(ExitCode code = ExitCode::kUsage) {
        return refusal([] { own_user_key(system_random_bytes()); }, code);
    }

    TemporaryDirectory folder_;
    const std::string before_ = std::getenv("XDG_STATE_HOME") == nullptr ? "" : std::getenv("XDG_STATE_HOME");
    const fs::path file_ = folder_ / "thimble/user.key";
};

TEST_F(UserKeyFile, IsMadeOnceForItsOwnerAlone) {
    const LabKey made = own_user_key(system_random_bytes());
    struct stat found {};
    ASSERT_EQ(stat(file_.c_str(), &found), 0);
    EXPECT_EQ(found.st_mode & 07777U, 0600U);
    EXPECT_TRUE(same_bytes(own_user_key(system_random_bytes()).bytes(), made.bytes()));
}

TEST_F(UserKeyFile, OfProgramsThatStartAtOnceIsOne) {
    constexpr std::size_t kPrograms = 8;
    for (int round = 0; round < 20; ++round) {
        fs::remove_all(file_.parent_path());
        std::array<std::string, kPrograms> keys;
        std::barrier start(kPrograms);
        std::vector<std::jthread> programs;
        programs.reserve(kPrograms);
        for (std::string& key : keys) {
            programs.emplace_back([&] {
                start.arrive_and_wait();
                key = hex(own_user_key(system_random_bytes()).bytes());
            });
        }
        programs.clear();
        for (const std::string& key : keys) EXPECT_EQ(key, keys[0]);
        EXPECT_EQ(std::distance(fs::directory_iterator(file_.parent_path()), {}), 1) << "no draft is left";
    }
}

TEST_F(UserKeyFile, ThatCannotBeMadeIsNamedWithTheRemedy) {
    write_text(folder_ / "thimble", "a file where the folder is to be");
    EXPECT_THAT(refused(), testing::AllOf(HasSubstr(file_.string()), HasSubstr("set XDG_STATE_HOME")));
    setenv("XDG_STATE_HOME", "/proc/nowhere", 1);  // where root cannot write either
    EXPECT_THAT(refused(), HasSubstr("'/proc/nowhere/thimble/user.key'"));
}

TEST_F(UserKeyFile, ThatOthersMayReadOrThatIsNoneIsRefused) {
    own_user_key(system_random_bytes());
    chmod(file_.c_str(), 0644);
    EXPECT_THAT(refused(), testing::AllOf(HasSubstr("the user key"), HasSubstr("chmod 600")));
    chmod(file_.c_str(), 0600);
    write_text(file_, "something");
    EXPECT_THAT(refused(ExitCode::kData), testing::AllOf(HasSubstr("no user key"), HasSubstr("remove it")));
}

TEST_F(UserKeyFile, OpensTheSocketsOfASessionFileThatSaysNothing) {
    prctl(PR_SET_DUMPABLE, 1UL, 0UL, 0UL, 0UL);  // whatever tests before this one did
    EXPECT_NE(Sockets{network("")}.security(), nullptr);
    EXPECT_TRUE(fs::exists(file_));
    EXPECT_EQ(Sockets{without_user_key(network(""))}.security(), nullptr);
    EXPECT_EQ(prctl(PR_GET_DUMPABLE), 1) << "a debugger of this user may look: he has the key anyway";
}

TEST_F(LabKeyFile, StandsWhereTheSettingTheEnvironmentOrTheStandardSays) {
    const auto set = [](const char* name, const char* value) {
        if (value == nullptr) unsetenv(name);
        if (value != nullptr) setenv(name, value, 1);
    };
    const char* const home = std::getenv("HOME");
    const std::string home_before = home == nullptr ? "" : home;
    const char* const state = std::getenv("XDG_STATE_HOME");
    const std::string state_before = state == nullptr ? "" : state;
    set("THIMBLE_LAB_KEY_FILE", nullptr);
    set("XDG_CONFIG_HOME", nullptr);
    set("HOME", "/home/somebody");
    EXPECT_EQ(lab_key_file(""), "/home/somebody/.config/thimble/lab.key");
    EXPECT_EQ(lab_key_file("~/my.key"), "/home/somebody/my.key");
    set("XDG_STATE_HOME", nullptr);
    EXPECT_EQ(user_key_file(), "/home/somebody/.local/state/thimble/user.key");
    set("XDG_STATE_HOME", "/state");
    EXPECT_EQ(user_key_file(), "/state/thimble/user.key");
    set("XDG_CONFIG_HOME", "relative");
    EXPECT_EQ(lab_key_file(""), "/home/somebody/.config/thimble/lab.key");
    set("XDG_CONFIG_HOME", "/config");
    EXPECT_EQ(lab_key_file(""), "/config/thimble/lab.key");
    set("THIMBLE_LAB_KEY_FILE", "/keys/lab");
    EXPECT_EQ(lab_key_file(""), "/keys/lab");
    EXPECT_EQ(lab_key_file("mine"), "mine");
    set("THIMBLE_LAB_KEY_FILE", nullptr);
    set("XDG_CONFIG_HOME", nullptr);
    set("HOME", nullptr);
    EXPECT_THROW(lab_key_file(""), Error);
    set("XDG_STATE_HOME", "relative");
    EXPECT_THAT(refusal(user_key_file, ExitCode::kUsage),
                testing::AllOf(HasSubstr("HOME names no folder"), HasSubstr("set XDG_STATE_HOME")));
    if (state != nullptr) set("XDG_STATE_HOME", state_before.c_str());
    if (state == nullptr) set("XDG_STATE_HOME", nullptr);
    if (home != nullptr) set("HOME", home_before.c_str());
}

}  // namespace
}  // namespace thimble
