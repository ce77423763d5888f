#pragma once

namespace thimble {

inline constexpr const char* kVersion = THIMBLE_VERSION;

}  // namespace thimble
