// kernel_path_peer: measures one way through a network between two network namespaces, and compares two such measurements.
// Used by tests/kernel/jobs/netem in the guest of deploy/kernel-lane.
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/node_program.hpp"
#include "common/version.hpp"
#include "tests/kernel/path_comparison.hpp"
#include "tests/kernel/path_traffic.hpp"

namespace {

using namespace thimble;

struct Options {
    PathTraffic traffic;
    std::string to, listen, out, name, kernel, relay;
    PathRequest asked;
};

CLI::App* add_measure(CLI::App& app, Options& o) {
    CLI::App* measure =
        app.add_subcommand("measure", "send 1 kHz through the network, write each packet's delay");
    measure->add_option("--sender", o.traffic.sender_namespace, "network namespace")->required();
    measure->add_option("--receiver", o.traffic.receiver_namespace, "network namespace")->required();
    measure->add_option("--to", o.to, "where the sender sends to")->type_name("HOST:PORT")->required();
    measure->add_option("--listen", o.listen, "where the receiver listens")
        ->type_name("[HOST:]PORT")
        ->required();
    measure->add_option("--packets", o.traffic.packets, "how many")
        ->check(CLI::Range(100, 1000000))
        ->required();
    measure->add_option("--out", o.out, "file for the delays")->required();
    return measure;
}

CLI::App* add_compare(CLI::App& app, Options& o) {
    CLI::App* compare =
        app.add_subcommand("compare", "the kernel's netem beside thimble-netem; 1 if they disagree");
    compare->add_option("--name", o.name, "of the profile, for the table")->required();
    compare->add_option("--kernel", o.kernel, "file that measure wrote")->required();
    compare->add_option("--relay", o.relay, "file that measure wrote")->required();
    compare->add_option("--delay-s", o.asked.delay_s, "what was asked")->check(CLI::Range(0.0, 60.0));
    compare->add_option("--normal-s", o.asked.normal_s, "standard deviation of a normal jitter")
        ->check(CLI::Range(0.0, 60.0));
    compare->add_option("--loss", o.asked.loss, "share of the packets")->check(CLI::Range(0.0, 1.0));
    return compare;
}

int measure(Options& o) {
    o.traffic.to = read_udp_address(o.to, "--to");
    o.traffic.listen = read_udp_address(o.listen, "--listen");
    write_path_sample(run_path_traffic(o.traffic), o.out);
    return static_cast<int>(ExitCode::kOk);
}

int compare(const Options& o) {
    const PathSummary kernel = summarise(read_path_sample(o.kernel));
    const PathSummary relay = summarise(read_path_sample(o.relay));
    const std::vector<std::string> findings = disagreements(o.asked, kernel, relay);
    fmt::print("{}", path_table_rows(o.name, o.asked, kernel, relay));
    for (const std::string& finding : findings) fmt::print(stderr, "{}: {}\n", o.name, finding);
    return static_cast<int>(findings.empty() ? ExitCode::kOk : ExitCode::kRunFailed);
}

int run(int argc, char** argv) {
    CLI::App app("One way through a network, measured between two network namespaces.", "kernel_path_peer");
    app.set_version_flag("--version", std::string(kVersion));
    app.require_subcommand(1);
    Options options;
    CLI::App* asked_measure = add_measure(app, options);
    CLI::App* asked_compare = add_compare(app, options);
    app.add_subcommand("head", "the head of the table that compare fills");
    if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
    if (asked_measure->parsed()) return measure(options);
    if (asked_compare->parsed()) return compare(options);
    fmt::print("{}", path_table_head());
    return static_cast<int>(ExitCode::kOk);
}

}  // namespace

int main(int argc, char** argv) {
    return guarded_main("kernel_path_peer", [&] { return run(argc, argv); });
}
