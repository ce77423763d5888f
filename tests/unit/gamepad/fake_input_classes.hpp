// A folder that looks like /sys/class/input.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>

#include "visual_node/gamepad/vibration.hpp"

namespace thimble {

class FakeInputClasses {
  public:
    FakeInputClasses() {
        std::string name = (std::filesystem::temp_directory_path() / "thimble_input_XXXXXX").string();
        folder_ = ::mkdtemp(name.data());
    }
    ~FakeInputClasses() { std::filesystem::remove_all(folder_); }
    FakeInputClasses(const FakeInputClasses&) = delete;
    FakeInputClasses& operator=(const FakeInputClasses&) = delete;

    // `effects`: as the kernel writes which force feedback there is.
    void add(const std::string& entry, const JoystickIdentity& identity, const std::string& effects) const {
        const auto device = folder_ / entry / "device";
        std::filesystem::create_directories(device / "capabilities");
        std::filesystem::create_directories(device / "id");
        std::ofstream(device / "name") << identity.name << '\n';
        std::ofstream(device / "id" / "vendor") << fmt::format("{:04x}\n", identity.vendor);
        std::ofstream(device / "id" / "product") << fmt::format("{:04x}\n", identity.product);
        std::ofstream(device / "capabilities" / "ff") << effects << '\n';
    }
    const std::filesystem::path& folder() const { return folder_; }

  private:
    std::filesystem::path folder_;
};

}  // namespace thimble
