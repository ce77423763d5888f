// thimble-netem as a node of a session: the network between the others.
#include <cmath>

#include <CLI/CLI.hpp>

#include "common/runtime/node_program.hpp"
#include "netem/commands/commands.hpp"
#include "netem/netem_process.hpp"
#include "netem/netem_settings.hpp"
#include "netem/profiles/profiles.hpp"

namespace thimble {
namespace {

class Netem final : public NodeInstance {
  public:
    Netem(const NetemSettings& settings, Sockets& sockets, std::uint64_t instance)
        : process_(instance, settings, sockets) {
        built_in_profile("");  // read now, not in the middle of a trial that changes its network
    }

    NodeProcess& process() override { return process_; }
    void describe(nlohmann::ordered_json& report) const override {
        for (const Relay& relay : process_.relays()) {
            LinkCounters counters = relay.before;
            counters += relay.model.counters();
            nlohmann::ordered_json& link = report["links"].emplace_back();
            for (const auto& [name, value] : kReportedCounters) link[std::string(name)] = counters.*value;
        }
    }

  private:
    NetemProcess process_;
};

}  // namespace

int run_node(int argc, char** argv) {
    double force_delay_s = std::nan(""), needle_delay_s = std::nan("");
    NodeProgram program;
    program.name = "thimble-netem";
    program.description =
        "Delays, varies and loses the datagrams between master and slave_sim: one link for the needle, one "
        "each for the force to handle, fingertips and screen.";
    program.example = "thimble-netem deploy/sessions/delay50.toml --force-delay-s 0.05";
    program.add_options = [&](CLI::App& app) {
        const CLI::Range most_a_minute(0.0, 60.0);
        app.add_option("--force-delay-s", force_delay_s,
                       "one-way delay of the force path, s, instead of [netem.force] delay_s")
            ->check(most_a_minute);
        app.add_option("--needle-delay-s", needle_delay_s,
                       "one-way delay of the needle path, s, instead of [netem.needle] delay_s")
            ->check(most_a_minute);
    };
    program.tables = {"network", "runtime", "netem"};
    program.relays = true;
    program.read = [](const ConfigFile& file) { read_netem_settings(file); };
    program.build = [&](const ConfigFile& file, Sockets& sockets, std::uint64_t instance) {
        NetemSettings settings = read_netem_settings(file);
        if (!std::isnan(force_delay_s))
            set_delay(settings.force, settings.force_timeline, from_seconds(force_delay_s));
        if (!std::isnan(needle_delay_s))
            set_delay(settings.needle, settings.needle_timeline, from_seconds(needle_delay_s));
        return std::make_unique<Netem>(settings, sockets, instance);
    };
    return run_node_program(program, argc, argv);
}

}  // namespace thimble
