// Messages between a client and WEART's middleware: text over TCP, port 13031, each one ended by '~'. Commands are words with ':'
// between them; states are JSON with the members "type", "ts" and "data".
//
// Read in WEART's public SDKs (MIT), not copied: WEARTHaptics/WEART-SDK-Cpp 6a2c395 (WeArtClient.cpp, WeArtMessages.cpp and .h,
// WeArtCommon.h) and WEARTHaptics/WEART-SDK-Python d8ba110 (README.md: states and codes). docs/fingertip.md says what is assumed.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "cutaneous_node/touchdiver/touchdiver_settings.hpp"

namespace thimble {

inline constexpr char kMiddlewareEnd = '~';
// Without the SDK's name, which asks for tracking too.
inline constexpr std::string_view kMiddlewareStart = "StartFromClient~", kMiddlewareStop = "StopFromClient~";

// Its two programs: the middleware (TouchDIVER), WEART-App (TouchDIVER Pro). Each asks and answers by a type of its own.
enum class MiddlewareKind : std::uint8_t { kUnknown, kMiddleware, kApp };

// Appends "force:0.300000:0.000000:0.000000:RIGHT:INDEX~". The share of the full force (0 to 1) is normal to the pulp.
void add_force(std::string& out, GloveSide side, Thimble thimble, double share);
// Appends "stopForce:RIGHT:INDEX~".
void add_stop_force(std::string& out, GloveSide side, Thimble thimble);
// Appends the question for the state, in both forms until the kind is known.
void add_question(std::string& out, MiddlewareKind kind, std::int64_t time_ms);

// The middleware's own state. The texts lie within the message.
struct MiddlewareStatus {
    MiddlewareKind kind = MiddlewareKind::kUnknown;
    std::string_view phase;    // "RUNNING", "IDLE", "DISCONNECTED", ...
    int code = 0;              // 0: in order
    std::string_view problem;  // of the code
    bool actuations = true;
    bool left = true, right = true;  // a device is connected; true where the message lists none of them
};

// Nothing: it is another message, or none at all.
std::optional<MiddlewareStatus> read_middleware_status(std::string_view message);
// A message that the SDKs know: JSON, or one of the middleware's commands.
bool is_middleware_message(std::string_view message);

}  // namespace thimble
