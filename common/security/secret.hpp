// Secret bytes: wiped when they go, never written by accident. Needs prepare_security() once per program.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

namespace thimble {

inline constexpr std::size_t kKeyBytes = 32;

// Fills the span. Real: the operating system's randomness; in virtual time: a seeded stream.
using RandomBytes = std::function<void(std::span<std::uint8_t>)>;
RandomBytes system_random_bytes();

// Finds the fastest code for this processor. Throws Error (run failed) if the library cannot start.
void prepare_security();

void wipe(std::span<std::uint8_t> bytes);
// In a time that does not tell where they differ.
bool same_bytes(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b);

// A key of a session. Copies are as secret as the first, and are wiped as well.
struct SecretKey {
    std::array<std::uint8_t, kKeyBytes> bytes{};

    SecretKey() = default;
    SecretKey(const SecretKey&) = default;
    SecretKey& operator=(const SecretKey&) = default;
    ~SecretKey() { wipe(bytes); }
};

// The lab's own key: in memory that is not swapped out if the system allows it, with guard pages around it.
class LabKey {
  public:
    explicit LabKey(std::span<const std::uint8_t, kKeyBytes> bytes);
    std::span<const std::uint8_t, kKeyBytes> bytes() const {
        return std::span<const std::uint8_t, kKeyBytes>{memory_.get(), kKeyBytes};
    }

  private:
    struct Release {
        void operator()(std::uint8_t* memory) const;
    };
    std::unique_ptr<std::uint8_t, Release> memory_;
};

}  // namespace thimble
