// Durations as people write them, in files and on the command line: a number of seconds, or a number and a unit, "50ms".
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace thimble {

inline constexpr std::string_view kDurationUnits = "ns, us, ms, s, min, h";

// Seconds of a number and a unit, "50ms" or "50 ms": the same double as 0.05, to the last bit. Nothing if it is none.
std::optional<double> parse_duration(std::string_view text);

// Whether a key or an option of this name holds seconds: "delay_s", "--delay-s", "--seconds"; not "speed_m_per_s".
bool holds_seconds(std::string_view name);

// No path on Earth, nor to the moon and back, is as long.
inline constexpr double kLongestPath_s = 3;

// The reason to doubt a network time (delay, jitter or slot in its name) in seconds without a unit: "50, but no
// network takes 50 s: ...". Empty if it is plausible.
std::string doubt_seconds(std::string_view name, double seconds);

// If a number is out of range but in range as milliseconds: how to write that. Else empty.
std::string meant_milliseconds(std::string_view name, double seconds, double low, double high);

// Replaces numbers with a unit in the word of an option by seconds, in lists ("0,9ms") and ranges ("0:200ms:41"),
// too. Returns what is wrong, empty if nothing is; it refuses numbers without a unit that are hardly meant.
std::string settle_durations(std::string_view name, std::string& word);

}  // namespace thimble
