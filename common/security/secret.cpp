#include "common/security/secret.hpp"

#include <cstring>
#include <sodium.h>

#include "common/error.hpp"

namespace thimble {

RandomBytes system_random_bytes() {
    return [](std::span<std::uint8_t> bytes) { randombytes_buf(bytes.data(), bytes.size()); };
}

void prepare_security() {
    if (sodium_init() < 0)
        throw Error(ExitCode::kRunFailed, "libsodium cannot start: is there a source of random numbers?");
}

void wipe(std::span<std::uint8_t> bytes) { sodium_memzero(bytes.data(), bytes.size()); }

bool same_bytes(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b) {
    return a.size() == b.size() && sodium_memcmp(a.data(), b.data(), a.size()) == 0;
}

LabKey::LabKey(std::span<const std::uint8_t, kKeyBytes> bytes) {
    prepare_security();
    memory_.reset(static_cast<std::uint8_t*>(sodium_malloc(kKeyBytes)));
    if (!memory_) throw Error(ExitCode::kRunFailed, "no memory for the lab key");
    std::memcpy(memory_.get(), bytes.data(), kKeyBytes);
    sodium_mprotect_readonly(memory_.get());
}

void LabKey::Release::operator()(std::uint8_t* memory) const { sodium_free(memory); }

}  // namespace thimble
