// The lab key as a file: its owner's alone, never overwritten.
#include "common/security/lab_key_file.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sys/stat.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/unit/security/security_rig.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class LabKeyFile : public testing::Test {
  protected:
    void SetUp() override {
        std::string name = (fs::temp_directory_path() / "thimble_key_XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
    }
    void TearDown() override { fs::remove_all(folder_); }

    void expect_refused(const fs::path& path, ExitCode code, const std::string& words) const {
        try {
            read_lab_key(path);
            ADD_FAILURE() << "read: " << path;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), code) << error.what();
            EXPECT_THAT(error.what(), HasSubstr(words));
            EXPECT_THAT(error.what(), HasSubstr(path.string()));
        }
    }
    fs::path write(const std::string& text) const {
        const fs::path path = folder_ / "written.key";
        std::ofstream(path) << text;
        chmod(path.c_str(), 0600);
        return path;
    }

    fs::path folder_;
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
    try {
        create_lab_key(path, seeded_bytes(1));
        ADD_FAILURE() << "overwritten";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kData);
    }
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
    expect_refused(path, ExitCode::kUsage, "belongs to somebody else");
}

// systemd's: root's, readable through an access list, which shows as the group's right.
TEST_F(LabKeyFile, IsTakenFromAServicesCredentials) {
    const fs::path path = folder_ / "lab.key";
    create_lab_key(path, seeded_bytes(1));
    setenv("CREDENTIALS_DIRECTORY", folder_.c_str(), 1);
    EXPECT_EQ(lab_key_file("/somewhere/else"), path);
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
    expect_refused(folder_, ExitCode::kUsage, "is not a file");
    const std::string good = "thimble-lab-key-1 paWlpaWlpaWlpaWlpaWlpaWlpaWlpaWlpaWlpaWlpaU=\n";
    EXPECT_NO_THROW(read_lab_key(write(good)));
    for (const std::string& text :
         {std::string(), good.substr(1), good.substr(0, good.size() - 1), good + "\n",
          "thimble-lab-key-2" + good.substr(17), good.substr(0, 20) + "!" + good.substr(21),
          std::string(good.size(), '\0')}) {
        expect_refused(write(text), ExitCode::kData, "no lab key");
    }
}

TEST_F(LabKeyFile, StandsWhereTheSettingTheEnvironmentOrTheStandardSays) {
    const auto set = [](const char* name, const char* value) {
        if (value == nullptr) unsetenv(name);
        if (value != nullptr) setenv(name, value, 1);
    };
    const char* const home = std::getenv("HOME");
    const std::string home_before = home == nullptr ? "" : home;
    set("THIMBLE_LAB_KEY_FILE", nullptr);
    set("XDG_CONFIG_HOME", nullptr);
    set("HOME", "/home/somebody");
    EXPECT_EQ(lab_key_file(""), "/home/somebody/.config/thimble/lab.key");
    EXPECT_EQ(lab_key_file("~/my.key"), "/home/somebody/my.key");
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
    if (home != nullptr) set("HOME", home_before.c_str());
}

}  // namespace
}  // namespace thimble
