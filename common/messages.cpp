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

}  // namespace

DeviceFault device_fault(std::string_view text) {
    DeviceFault fault;
    std::size_t length = 0;
    for (const char c : text) {
        if (length < fault.text.size() && c >= ' ' && c <= '~') fault.text[length++] = c;
    }
    return fault;
}

std::string_view text_of(const DeviceFault& fault) {
    const std::string_view all(fault.text.data(), fault.text.size());
    return all.substr(0, std::min(all.find('\0'), all.size()));
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
    static constexpr std::array kNames{"none", "completed", "timeout", "peer_lost", "interrupted"};
    return name_of(kNames, reason);
}

const char* to_string(NodeState state) {
    static constexpr std::array kNames{"idle", "running", "finished", "failed"};
    return name_of(kNames, state);
}

}  // namespace thimble
