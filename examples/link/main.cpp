// What a network does to packets, without a network and without waiting: a LinkModel in virtual time.
//   link [NAME|FILE|WORDS]    as thimble-netem --profile, e.g. leo or "delay 50ms 5ms loss 1%"
#include <array>
#include <cstdint>
#include <cstdio>
#include <string>

#include "common/error.hpp"
#include "netem/link_model.hpp"
#include "netem/profiles/profiles.hpp"

namespace {

using namespace std::chrono_literals;

void send_for_ten_seconds(thimble::LinkModel& link) {
    const std::array<std::uint8_t, 100> datagram{};
    thimble::SessionTime now{};
    for (int millisecond = 0; millisecond < 10'000; ++millisecond, now += 1ms) {
        link.push(now, datagram);
        while (!link.pop_due(now).empty()) {
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const auto profile = thimble::load_profile(argc > 1 ? argv[1] : "lte");
        // The same key: the same fate for each packet, on every machine.
        thimble::LinkModel link(profile.up, thimble::StreamKey{.study = 1}, 0, profile.up_changes);
        send_for_ten_seconds(link);
        const thimble::LinkCounters& counters = link.counters();
        std::printf("%s: %llu packets sent, %llu delivered, %llu lost, mean delay %.2f ms\n",
                    profile.name.c_str(), static_cast<unsigned long long>(counters.pushed),
                    static_cast<unsigned long long>(counters.delivered),
                    static_cast<unsigned long long>(counters.lost), link.delays().mean_s() * 1e3);
        return 0;
    } catch (const thimble::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return static_cast<int>(error.code());
    }
}
