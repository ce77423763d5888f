// The networks of deploy/profiles in the words of people who have never heard of a profile: on buttons, and on the page.
#pragma once

#include <array>
#include <string_view>

namespace thimble {

struct NetworkWords {
    std::string_view profile;
    const char* words;  // with the delay one way, where the name does not tell it
};

inline constexpr std::array kNetworkWords{
    NetworkWords{"ideal", "No delay"},
    NetworkWords{"tactile", "Internet of the future, 0.5 ms"},
    NetworkWords{"lan", "Cable in the lab"},
    NetworkWords{"wifi", "Wi-Fi, 2 ms"},
    NetworkWords{"5g-nsa", "Mobile, 5G"},
    NetworkWords{"iss-direct", "Space station overhead, 12 ms"},
    NetworkWords{"leo", "Low satellite"},
    NetworkWords{"lte", "Mobile, 35 ms"},
    NetworkWords{"transatlantic", "Across the Atlantic, 40 ms"},
    NetworkWords{"paper50", "Study, 50 ms"},
    NetworkWords{"4g", "Slow mobile, 85 ms"},
    NetworkWords{"geo", "Satellite, 300 ms"},
    NetworkWords{"iss-tdrs", "Space station by satellites, 400 ms"},
    NetworkWords{"moon", "The Moon, 1.3 s"},
};

// Null for a network that does not come with the programs.
constexpr const char* network_words(std::string_view profile) {
    for (const NetworkWords& network : kNetworkWords)
        if (network.profile == profile) return network.words;
    return nullptr;
}

}  // namespace thimble
