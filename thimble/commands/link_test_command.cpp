// thimble link-test: is the network between two machines good enough, before an experiment finds out?
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "session/clocks/chrony.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/shared.hpp"
#include "thimble/link_test/echo_responder.hpp"
#include "thimble/link_test/link_report.hpp"

namespace thimble {
namespace {

struct LinkTestArguments {
    std::string host, session;
    int base_port = 0;
    std::optional<double> seconds_s;
    std::vector<unsigned> offsets;
    bool listen = false, json = false;
};

std::vector<Port> chosen_ports(const LinkTestArguments& arguments, std::vector<Port> all) {
    if (arguments.offsets.empty()) return all;
    std::vector<Port> ports;
    const std::set<unsigned> once(arguments.offsets.begin(), arguments.offsets.end());
    ports.reserve(once.size());
    for (const unsigned offset : once) ports.push_back(static_cast<Port>(offset));
    return ports;
}

void ask_scheduler(const ConfigFile& file) {
    install_stop_signals();
    const std::string warning = ask_for_realtime(read_runtime_settings(file));
    if (!warning.empty()) spdlog::warn(warning);
}

int listen(const LinkTestArguments& arguments, const ConfigFile& file) {
    EchoPlan plan;
    plan.base_port = network_of(arguments.session, arguments.base_port).base_port;
    plan.ports = chosen_ports(arguments, ports_on({}, ""));
    plan.limit = from_seconds(arguments.seconds_s.value_or(600));
    plan.stop = &stop_requested();
    ask_scheduler(file);
    const EchoCounters counters = serve_echoes(plan);
    spdlog::info(
        "{} answered; not answered: {} malformed, {} at a wrong port, {} without a valid nonce, {} over the "
        "limits, {} while too many tests ran",
        counters.answered, counters.malformed, counters.wrong_port, counters.wrong_nonce, counters.limited,
        counters.crowded);
    return static_cast<int>(ExitCode::kOk);
}

int test(const LinkTestArguments& arguments, const ConfigFile& file) {
    const SystemSettings settings = load_system_settings(arguments.session);
    const NetworkSettings network = network_of(arguments.session, arguments.base_port);
    LinkTestPlan plan;
    plan.host = arguments.host;
    plan.base_port = network.base_port;
    plan.ports = chosen_ports(arguments, ports_on(network, arguments.host));
    plan.duration = from_seconds(arguments.seconds_s.value_or(5));
    plan.stop = &stop_requested();
    ask_scheduler(file);
    LinkReport report;
    report.chrony = describe_chrony();
    report.link = test_link(plan);
    if (stop_requested()) throw Error(ExitCode::kRunFailed, "interrupted: half a test gives no verdict");
    report.verdicts = judge_all(settings.plan.modalities, report.link, loop_limits(settings));
    fmt::print("{}", arguments.json ? json_text(to_json(report), 2) + "\n" : to_text(report));
    return static_cast<int>(exit_code(report));
}

int link_test(const LinkTestArguments& arguments) {
    if (arguments.listen != arguments.host.empty()) {
        throw Error(
            ExitCode::kUsage,
            "name the other machine with --host to test the link to it, or give --listen to answer tests");
    }
    const ConfigFile file =
        arguments.session.empty() ? ConfigFile::empty() : ConfigFile::load(arguments.session);
    return arguments.listen ? listen(arguments, file) : test(arguments, file);
}

}  // namespace

Subcommand add_link_test(CLI::App& app) {
    const auto arguments = std::make_shared<LinkTestArguments>();
    LinkTestArguments& a = *arguments;
    CLI::App* command = app.add_subcommand(
        "link-test",
        "test the link to another machine: do its ports answer, is it fast enough for a session?");
    add_session_option(*command, a.session,
                       "session file (TOML) or built-in name: its ports, modalities and limits are tested");
    command->add_option("--host", a.host, "the other machine, where 'thimble link-test --listen' runs");
    command->add_flag("--listen", a.listen,
                      "answer the tests of other machines; sends no more data than it receives");
    add_base_port_option(*command, a.base_port);
    command
        ->add_option("--ports", a.offsets,
                     "test only these offsets from the base port, e.g. 11,14 (docs/protocol.md)")
        ->delimiter(',')
        ->check(CLI::Range(0U, static_cast<unsigned>(Port::kCount) - 1));
    command
        ->add_option("--seconds", a.seconds_s,
                     "how long to test (default 5), or with --listen how long to answer (default 600), s")
        ->check(CLI::Range(0.1, 86400.0));
    command->add_flag("--json", a.json, "print JSON on stdout, instead of tables");
    command->footer(
        "Verdicts: HF fits if the round trip is shorter than the critical delay of the force loop.\n"
        "CF, CCF and VF fit if the round trip is at most half of the modality's own latency (display and "
        "reaction time), and are marginal up to that latency.\n"
        "The delay that a session emulates comes on top of the measured one.\n"
        "\n"
        "Examples:\n"
        "  thimble link-test --listen                                     # on the other machine\n"
        "  thimble link-test deploy/sessions/delay50.toml --host 192.168.1.20\n"
        "  thimble link-test --host 192.168.1.20 --ports 11,14 --seconds 60 --json\n"
        "\n"
        "Exit codes: 0 every modality fits or is marginal, 1 one does not fit (or interrupted), 2 usage, 3 a "
        "port does not answer or a session's datagrams are lost.");
    return {command, [arguments] { return link_test(*arguments); }};
}

}  // namespace thimble
