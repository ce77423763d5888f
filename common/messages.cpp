#include "common/messages.hpp"

#include <algorithm>
#include <array>

namespace thimble {
namespace {

template <std::size_t N, class Enum>
const char* name_of(const std::array<const char*, N>& names, Enum value) {
    const auto index = static_cast<std::size_t>(value);
    return index < N ? names[index] : "invalid";
}

// One place is left for the zero that ends it.
template <std::size_t N>
void put(std::string_view words, std::array<char, N>& text) {
    std::copy_n(words.begin(), std::min(words.size(), text.size() - 1), text.begin());
}

template <std::size_t N>
std::string_view up_to_zero(const std::array<char, N>& text) {
    return {text.data(), static_cast<std::size_t>(std::find(text.begin(), text.end(), '\0') - text.begin())};
}

}  // namespace

std::optional<NetworkName> NetworkName::of(std::string_view text) {
    NetworkName name;
    if (text.size() >= name.text.size()) return std::nullopt;
    const bool legal = std::all_of(text.begin(), text.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
    });
    if (!legal) return std::nullopt;
    std::copy(text.begin(), text.end(), name.text.begin());
    return name;
}

std::string_view NetworkName::view() const {
    const auto end = std::find(text.begin(), text.end(), 0);
    return {reinterpret_cast<const char*>(text.data()), static_cast<std::size_t>(end - text.begin())};
}

const char* to_string(Role role) {
    static constexpr std::array kNames{"session", "master", "slave_sim",   "cutaneous",
                                       "visual",  "netem",  "experimenter"};
    return name_of(kNames, role);
}

const char* to_string(Modality modality) {
    static constexpr std::array kNames{"HF", "CF", "CCF", "VF"};
    return name_of(kNames, modality);
}

std::optional<Modality> find_modality(std::string_view text) {
    for (const Modality modality : kModalities) {
        if (text == to_string(modality)) return modality;
    }
    return std::nullopt;
}

const char* to_string(TissuePhase phase) {
    static constexpr std::array kNames{"free", "contact", "penetrated"};
    return name_of(kNames, phase);
}

const char* to_string(EndReason reason) {
    static constexpr std::array kNames{"none",        "completed",    "timeout",     "peer_lost",
                                       "interrupted", "device_fault", "safety_stop", "emergency_stop"};
    return name_of(kNames, reason);
}

DeviceFault::DeviceFault(std::string_view words) { put(words, text); }

std::string_view DeviceFault::words() const { return up_to_zero(text); }

StopOrder::StopOrder(std::uint64_t number, StopKind what, EndReason why, std::string_view words)
    : id(number), kind(what), reason(why) {
    put(words, text);
}

std::string_view StopOrder::words() const { return up_to_zero(text); }

const char* to_string(NodeState state) {
    static constexpr std::array kNames{"idle", "running", "finished", "failed"};
    return name_of(kNames, state);
}

}  // namespace thimble
