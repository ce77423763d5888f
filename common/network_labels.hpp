// Labels of the networks in deploy/profiles, for buttons and the page: they need no knowledge of profiles.
#pragma once

#include <array>
#include <string_view>

namespace thimble {

struct NetworkLabel {
    std::string_view profile;
    const char* label;  // with the delay one way, where the name does not tell it
};

inline constexpr std::array kNetworkLabels{
    NetworkLabel{"ideal", "No delay"},
    NetworkLabel{"tactile", "Internet of the future, 0.5 ms"},
    NetworkLabel{"lan", "Cable in the lab"},
    NetworkLabel{"wifi", "Wi-Fi, 2 ms"},
    NetworkLabel{"5g-nsa", "Mobile, 5G"},
    NetworkLabel{"iss-direct", "Space station overhead, 12 ms"},
    NetworkLabel{"leo", "Low satellite"},
    NetworkLabel{"lte", "Mobile, 35 ms"},
    NetworkLabel{"transatlantic", "Across the Atlantic, 40 ms"},
    NetworkLabel{"paper50", "Study, 50 ms"},
    NetworkLabel{"4g", "Slow mobile, 85 ms"},
    NetworkLabel{"geo", "Satellite, 300 ms"},
    NetworkLabel{"iss-tdrs", "Space station by satellites, 400 ms"},
    NetworkLabel{"moon", "The Moon, 1.3 s"},
};

// Null for a network that does not come with the programs.
constexpr const char* network_label(std::string_view profile) {
    for (const NetworkLabel& network : kNetworkLabels)
        if (network.profile == profile) return network.label;
    return nullptr;
}

}  // namespace thimble
