// thimble stop: an emergency stop from any terminal, and its release.
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/error.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/sockets.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/stop_line.hpp"
#include "common/stop_release.hpp"
#include "experiment/commands/commands.hpp"
#include "experiment/stop_file.hpp"

namespace thimble {
namespace {

// As many as [session] lanes may be: a stop that is said where nobody runs does no harm.
constexpr int kMostLanes = 64;

struct StopArguments {
    std::string config, reason = "thimble stop";
    int base_port = 0, lanes = 0;
    bool release = false;
};

NetworkSettings lane_network(const StopArguments& a, int lane) {
    const ConfigFile file = a.config.empty() ? ConfigFile::empty() : ConfigFile::load(a.config);
    NetworkSettings network = read_network_settings(file);
    const int base = a.base_port != 0 ? a.base_port : network.base_port;
    network.base_port = static_cast<std::uint16_t>(base + lane * static_cast<int>(Port::kCount));
    return network;
}

int lanes_of(const StopArguments& a) {
    const int base = lane_network(a, 0).base_port;
    const int possible = (65536 - base) / static_cast<int>(Port::kCount);
    return std::clamp(a.lanes == 0 ? 8 : a.lanes, 1, possible);
}

// The stop lines of all lanes, and what is said there.
template <class Talk>
class Lanes {
  public:
    explicit Lanes(const StopArguments& a) {
        const auto count = static_cast<std::size_t>(lanes_of(a));
        sockets_.reserve(count);
        talks_.reserve(count);
        const std::uint64_t instance = system_entropy();
        for (std::size_t i = 0; i < count; ++i) {
            sockets_.push_back(std::make_unique<Sockets>(lane_network(a, static_cast<int>(i))));
            talks_.push_back(std::make_unique<Talk>(instance, sockets_.back()->stop_outlets()));
        }
    }
    template <class Say>
    void every_round(int rounds, Say&& say) {
        for (int i = 0; i < rounds; ++i) {
            if (i > 0) wall_sleep(kStopRepeat);
            for (const auto& talk : talks_) say(*talk);
        }
    }
    const std::vector<std::unique_ptr<Talk>>& talks() const { return talks_; }

  private:
    std::vector<std::unique_ptr<Sockets>> sockets_;
    std::vector<std::unique_ptr<Talk>> talks_;
};

struct StopTalk {
    StopTalk(std::uint64_t instance, const StopOutlets& out)
        : flow(Role::kExperimenter, instance, {out[0], out[1], out[2], out[3], out[4], out[5]}) {}
    OutboundFlow flow;
};

// Said ten times within half a second: it is carried out once.
int stop(const StopArguments& a) {
    const std::uint64_t id = std::max<std::uint64_t>(1, system_entropy());
    const StopOrder order(id, StopKind::kStop, EndReason::kEmergencyStop, a.reason);
    Lanes<StopTalk>(a).every_round(kReleaseTimes,
                                   [&order](StopTalk& talk) { talk.flow.send(wall_now(), 0, order); });
    fmt::print("emergency stop (ports from {}): no force, no trial begins; {}\n",
               lane_network(a, 0).base_port, kHowToRelease);
    return 0;
}

int release(const StopArguments& a) {
    Lanes<StopRelease> lanes(a);
    lanes.every_round(StopRelease::kRounds, [](StopRelease& talk) { talk.round(wall_now()); });
    const int base = lane_network(a, 0).base_port;
    bool any = false;
    for (const auto& lane : lanes.talks()) {
        for (const StopOrder& stop : lane->stops()) fmt::print("released: {}\n", stop.words());
        any = any || !lane->stops().empty();
    }
    for (int lane = 0; lane < lanes_of(a); ++lane) {
        const auto kept = StopFile(lane_network(a, lane).base_port).release();
        if (kept) fmt::print("released, of a session that has ended: {}\n", *kept);
        any = any || kept;
    }
    fmt::print("{} (ports from {})\n",
               any ? "trials may begin again" : "nothing was stopped here, as far as programs answer", base);
    return 0;
}

}  // namespace

Subcommand add_stop(CLI::App& app) {
    const auto arguments = std::make_shared<StopArguments>();
    StopArguments& a = *arguments;
    CLI::App* sub = app.add_subcommand(
        "stop", "emergency stop of a running session: no force at the handle, cables slack, needle held");
    sub->add_option("session", a.config, "session file (TOML), for its [network]; without it this machine");
    sub->add_flag("--release", a.release, "let trials begin again");
    sub->add_option("--reason", a.reason, "goes into the record's words; no names");
    sub->add_option("--base-port", a.base_port, "first UDP port, instead of [network].base_port")
        ->check(CLI::Range(1024, 65536 - static_cast<int>(Port::kCount)))
        ->type_name("PORT");
    sub->add_option("--lanes", a.lanes, "so many lanes of a run side by side (8)")
        ->check(CLI::Range(1, kMostLanes));
    sub->footer(
        "Where thimble runs in this terminal, Ctrl-\\ does the same. A stop that a session ended with holds "
        "for the next one on "
        "its ports: release it on the machine of that session.\n"
        "Examples:\n  thimble stop\n  thimble stop --release\n  thimble stop lab.toml --reason \"cable "
        "loose\"");
    return {sub, [arguments] { return arguments->release ? release(*arguments) : stop(*arguments); }};
}

}  // namespace thimble
