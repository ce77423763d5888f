// thimble stop: an emergency stop from any terminal, and its release.
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/error.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/protection.hpp"
#include "common/runtime/sockets.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/security/lab_key_file.hpp"
#include "common/stop_inquiry.hpp"
#include "session/run/stop_file.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/shared.hpp"

namespace thimble {
namespace {

// The most that [session] parallel_conditions allows. A stop to ports without a session does no harm.
constexpr int kMostConditions = 64;
constexpr int kMoreRounds = 40;  // for the answer of a machine that is busy

struct StopArguments {
    std::string config, reason = "thimble stop";
    int base_port = 0, conditions = 0;
    bool release = false;
};

NetworkSettings condition_network(const StopArguments& a, int condition) {
    NetworkSettings network = network_of(a.config, a.base_port);
    network.base_port =
        static_cast<std::uint16_t>(network.base_port + condition * static_cast<int>(Port::kCount));
    return network;
}

int condition_count(const StopArguments& a) {
    const int base = condition_network(a, 0).base_port;
    const int possible = (65536 - base) / static_cast<int>(Port::kCount);
    return std::clamp(a.conditions == 0 ? 8 : a.conditions, 1, possible);
}

template <class Talk>
struct OpenBus {
    int base_port = 0;
    bool without_key = false;  // beside the one under the user key
    std::unique_ptr<Talk> talk;
};

// Opens the stop buses of all conditions.
template <class Talk>
class Conditions {
  public:
    explicit Conditions(const StopArguments& a) {
        const auto count = static_cast<std::size_t>(condition_count(a));
        sockets_.reserve(2 * count);
        buses_.reserve(2 * count);
        const std::uint64_t instance = system_entropy();
        for (std::size_t i = 0; i < count; ++i) {
            const NetworkSettings network = condition_network(a, static_cast<int>(i));
            const bool user_key = network.security.mode == SecurityMode::kUserKey;
            // To make a key waits for the disk. A key made now is no session's key.
            if (!user_key || has_user_key()) add(network, instance, false);
            // A run in lock-step has no user key. A program with one refuses a stop without a seal.
            if (user_key) add(without_user_key(network), instance, true);
        }
    }
    void rounds(int count) {
        for (int i = 0; i < count; ++i) {
            if (i > 0) wall_sleep(kStopRepeat);
            for (const OpenBus<Talk>& bus : buses_) bus.talk->round(wall_now());
        }
    }
    // More of them for a busy machine, until `done`.
    template <class Done>
    void rounds_until(const Done& done) {
        for (int more = 0; !done() && more < kMoreRounds; ++more) {
            wall_sleep(kStopRepeat);
            rounds(1);
        }
    }
    const std::vector<OpenBus<Talk>>& buses() const { return buses_; }

  private:
    void add(const NetworkSettings& network, std::uint64_t instance, bool without_key) {
        sockets_.push_back(std::make_unique<Sockets>(network));
        buses_.push_back({network.base_port, without_key,
                          std::make_unique<Talk>(instance, stop_outlets(*sockets_.back()))});
    }
    std::vector<std::unique_ptr<Sockets>> sockets_;
    std::vector<OpenBus<Talk>> buses_;
};

// Sends the stop ten times (it acts once), then asks which programs hold it.
class StopCall {
  public:
    // `instance`, random per start, is also the stop's number.
    StopCall(std::uint64_t instance, const StopOutlets& at)
        : id_(instance),
          out_(Role::kExperimenter, instance, {at[0], at[1], at[2], at[3], at[4], at[5]}),
          inquiry_(out_, at, instance) {}
    void stop(const std::string& reason) {
        order_ = StopOrder(id_, StopKind::kStop, EndReason::kEmergencyStop, reason);
    }
    void round(SessionTime now) {
        inquiry_.hear(now);
        if (said_++ < kReleaseTimes) out_.send(now, 0, order_);
        inquiry_.ask(now);
    }
    // The programs that hold this stop, "session, master". Another stop says nothing about this one.
    std::string holders() const {
        std::array<bool, kRoleCount> holds{};
        for (const LatchedStop& held : inquiry_.held()) {
            if (held.stop.id == id_) holds.at(static_cast<std::size_t>(held.by)) = true;
        }
        std::string names;
        for (std::size_t role = 0; role < holds.size(); ++role) {
            if (holds.at(role))
                names += (names.empty() ? "" : ", ") + std::string(to_string(static_cast<Role>(role)));
        }
        return names;
    }

  private:
    std::uint64_t id_;
    OutboundFlow out_;
    StopInquiry inquiry_;
    StopOrder order_;
    int said_ = 0;
};

// Where the answers may be: the programs that are asked are those of this file, or of this machine.
std::string where(const StopArguments& a) {
    const int base = condition_network(a, 0).base_port;
    return a.config.empty() ? fmt::format("ports from {}", base)
                            : fmt::format("{}, ports from {}", a.config, base);
}

// "", or " lab.toml --base-port 28000".
std::string same_arguments(const StopArguments& a) {
    std::string text = a.config.empty() ? "" : " " + a.config;
    if (a.base_port != 0) text += fmt::format(" --base-port {}", a.base_port);
    return text;
}

// "session, master (ports from 27000); session (ports from 27033)"
std::string holders(const Conditions<StopCall>& conditions, bool without_key) {
    std::string text;
    for (const OpenBus<StopCall>& bus : conditions.buses()) {
        const std::string names = bus.without_key == without_key ? bus.talk->holders() : std::string();
        if (names.empty()) continue;
        text += fmt::format("{}{} (ports from {})", text.empty() ? "" : "; ", names, bus.base_port);
    }
    return text;
}

// `open`: who has confirmed it without a key, as any user of the machine can.
std::string not_confirmed(const StopArguments& a, const std::string& open) {
    const std::string so_far =
        open.empty()
            ? fmt::format("no program confirmed the stop ({})", where(a))
            : fmt::format("the stop was confirmed only without a key (a lock-step run?), by {}", open);
    return fmt::format(
        "{}. A session {}that runs there has NOT been stopped, or cannot answer. As the user who runs it, "
        "name its session file: thimble stop SESSION.toml. Or press Backspace in a window, or switch the "
        "device off",
        so_far, open.empty() ? "" : "with a key ");
}

// The user must know whether the stop was heard.
int stop(const StopArguments& a) {
    Conditions<StopCall> conditions(a);
    for (const OpenBus<StopCall>& bus : conditions.buses()) bus.talk->stop(a.reason);
    conditions.rounds(kReleaseTimes + 1);
    conditions.rounds_until([&] { return !holders(conditions, false).empty(); });
    const std::string by = holders(conditions, false), open = holders(conditions, true);
    if (by.empty()) throw Error(ExitCode::kNetwork, not_confirmed(a, open));
    fmt::print("emergency stop ({}): forces are off and no trial can begin; confirmed by {}{}{}; {}{}\n",
               where(a), by, open.empty() ? "" : "; without a key (a lock-step run?) by ", open,
               kHowToRelease, same_arguments(a));
    return 0;
}

bool names_a_stop(const Conditions<StopRelease>& conditions) {
    return std::any_of(conditions.buses().begin(), conditions.buses().end(),
                       [](const OpenBus<StopRelease>& bus) { return !bus.talk->stops().empty(); });
}

// A program that gets no processor for a second still holds its stop.
void ask_and_release(Conditions<StopRelease>& conditions) {
    conditions.rounds(StopRelease::kRounds);
    if (names_a_stop(conditions)) return;
    conditions.rounds_until([&] { return names_a_stop(conditions); });
    if (names_a_stop(conditions)) conditions.rounds(kReleaseTimes);
}

int release(const StopArguments& a) {
    std::vector<StopFile> files;
    std::vector<std::optional<StopFile::Kept>> kept;
    for (int condition = 0; condition < condition_count(a); ++condition) {
        files.emplace_back(condition_network(a, condition).base_port);
        kept.push_back(files.back().kept());
    }
    Conditions<StopRelease> conditions(a);
    ask_and_release(conditions);
    for (const OpenBus<StopRelease>& bus : conditions.buses()) {
        for (const StopOrder& stop : bus.talk->stops())
            fmt::print("released: {}\n", printable(std::string(stop.words())));
    }
    const bool answered = names_a_stop(conditions);
    bool removed = false;
    for (std::size_t condition = 0; condition < files.size(); ++condition) {
        if (!files[condition].release(kept[condition])) continue;
        fmt::print("released, although its session has ended: {}\n", printable(kept[condition]->words));
        removed = true;
    }
    fmt::print("{} ({})\n",
               answered  ? "trials can begin again"
               : removed ? "sessions can start again here; no running program answered that it holds a stop"
                         : "nothing was stopped here, according to the programs that answered",
               where(a));
    return 0;
}

}  // namespace

Subcommand add_stop(CLI::App& app) {
    const auto arguments = std::make_shared<StopArguments>();
    StopArguments& a = *arguments;
    CLI::App* sub = app.add_subcommand(
        "stop", "stop a running session at once: forces go to zero, cables go slack, the needle is held");
    add_session_option(
        *sub, a.config,
        "session file (TOML) or built-in name, for its [network] and [security]; default: this machine");
    sub->add_flag("--release", a.release, "release the stop, so that trials can begin again");
    sub->add_option("--reason", a.reason, "reason, which is recorded; do not name people");
    add_base_port_option(*sub, a.base_port);
    sub->add_option("--parallel-conditions", a.conditions,
                    "how many parallel conditions the run has (default 8)")
        ->check(CLI::Range(1, kMostConditions));
    sub->footer(
        "The command lists the programs that confirm the stop. It exits with 3 if none does, or only a "
        "lock-step run without a key.\n"
        "In the terminal of a running thimble, Ctrl-\\ does the same.\n"
        "The stop stays until you release it: no session can start on these ports before that. Release it on "
        "the machine that runs the session.\n"
        "\n"
        "Examples:\n"
        "  thimble stop\n"
        "  thimble stop --release\n"
        "  thimble stop lab.toml --reason \"cable loose\"");
    return {sub, [arguments] { return arguments->release ? release(*arguments) : stop(*arguments); }};
}

}  // namespace thimble
