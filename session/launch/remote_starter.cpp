#include "session/launch/remote_starter.hpp"

#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdint>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "common/json_text.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/text_file.hpp"
#include "common/version.hpp"
#include "session/launch/remote_script.hpp"
#include "session/launch/remote_shell.hpp"

namespace thimble {
namespace {

constexpr Duration kSignOfLife = std::chrono::seconds{1};
// The script needs two to kill a node that hangs; the rest is the way there and back.
constexpr Duration kGoodbye = std::chrono::seconds{5};
constexpr Duration kNothingToClean = std::chrono::milliseconds{500};
// Of a log: slower than any network that carries a session, and no log is worth more.
constexpr double kSlowest_bytes_per_s = 1e5;
constexpr Duration kLongestLog = std::chrono::minutes{10};
constexpr int kDeepestReport = 20;
constexpr int kConnectionLost = 255;  // ssh(1), EXIT STATUS

std::vector<std::string> command_to(const LaunchSettings& launch, const std::string& machine) {
    std::vector<std::string> words = exec_words(launch, machine);
    words.emplace_back("sh");
    return words;
}

class RemoteNode final : public RunningNode {
  public:
    RemoteNode(const LaunchSettings& launch, const SessionBundle& bundle, const NodeOrder& order)
        : order_(order),
          bundle_(bundle),
          machine_(launch.machine(order.role)),
          command_(command_to(launch, machine_)),
          shell_(command_, order.log) {
        shell_.divert_after(kEnded, order.messages);
        shell_.send(
            remote_script({order.program, launch.programs, kVersion, machine_, bundle.files.front().name,
                           launch.lease, order.arguments, !order.messages.empty(), order.grant_key}));
    }
    ~RemoteNode() override {
        stop();
        while (!heard_out()) wall_sleep(std::chrono::milliseconds{1});
        poll();
        if (code_) save_report();  // with what was heard since
    }

    std::optional<int> poll() override {
        if (code_) return code_;
        const auto code = shell_.poll();
        code_ = shell_.diverted() ? exit_code_told() : code;
        if (!code_) code_ = code;  // its last word lacks the number
        if (code_) note_stop_requests();
        if (code_) save_report();
        if (code_) return code_;
        if (!started_ && shell_.has_said(kSend)) {
            shell_.send(to_stream(bundle_));
            started_ = true;
        }
        if (started_) give_sign_of_life();
        return std::nullopt;
    }
    bool started() const override { return started_ && shell_.all_sent(); }
    void stop() override {
        note_stop_requests();
        shell_.hang_up();
    }
    bool heard_out() override;
    const std::string& program() const override { return order_.program; }
    std::string exit_message() override;
    ExitCode verdict() const override {
        return code_ == kNoProgram || code_ == kOtherVersion || code_ == kNoFolder ? ExitCode::kRunFailed
                                                                                   : ExitCode::kNetwork;
    }

  private:
    // Not on top of what could not be sent yet: after a while without a way there it would only pile up.
    void give_sign_of_life() {
        const SessionTime now = wall_now();
        if (now < next_sign_ || !shell_.all_sent()) return;
        next_sign_ = now + kSignOfLife;
        shell_.send("\n");
    }
    // From its end on: a signal that comes later is from a user who does not want to wait for its last words.
    void note_stop_requests() {
        if (!stops_before_) stops_before_ = stop_requests();
    }
    Duration patience() const { return started_ ? kGoodbye : kNothingToClean; }
    std::optional<int> exit_code_told() const;
    Duration longest() const;
    std::string log_fault() const;
    void save_report();

    NodeOrder order_;
    const SessionBundle& bundle_;
    std::string machine_;
    std::vector<std::string> command_;
    RemoteShell shell_;
    bool started_ = false;
    std::optional<int> code_;
    std::optional<unsigned> stops_before_;
    std::uint64_t heard_ = 0;                                  // bytes, when heard_out() was asked last
    std::optional<SessionTime> waiting_since_, silent_since_;  // of heard_out()
    bool told_report_ = false;                                 // that it cannot be written
    SessionTime next_sign_{};
};

std::string RemoteNode::exit_message() {
    const int code = poll().value_or(-1);
    const std::string words = shell_.last_lines();
    if (!shell_.fault().empty()) {
        return fmt::format("'{}' was cut off, where {} ran: it {}; look at what '{}' prints there", machine_,
                           order_.program, shell_.fault(), fmt::join(command_, " "));
    }
    if (!shell_.has_said(kReached)) {
        return fmt::format("cannot reach '{}' for {}: '{}' ended with code {}: {}", machine_, order_.program,
                           fmt::join(command_, " "), code, words);
    }
    if (code == kConnectionLost) {
        return fmt::format("lost the connection to '{}', which {} ran on: '{}' ended with code {}: {}",
                           machine_, order_.program, fmt::join(command_, " "), code, words);
    }
    return fmt::format("{} on '{}' ended with code {}: {}", order_.program, machine_, code, words);
}

// Its node may have ended while its log is still on its way.
std::optional<int> RemoteNode::exit_code_told() const {
    int code = -1;
    const std::string& numbers = *shell_.diverted();
    if (numbers.empty()) return std::nullopt;
    std::from_chars(numbers.data() + 1, numbers.data() + numbers.size(), code);
    return code;
}

// The whole of its log, as long as that comes, in a time that fits its length. A signal ends the wait.
bool RemoteNode::heard_out() {
    if (shell_.poll()) return true;
    const SessionTime now = wall_now();
    if (!waiting_since_) waiting_since_ = now;
    if (!silent_since_ || heard_ != shell_.heard()) silent_since_ = now;
    heard_ = shell_.heard();
    const bool late = now - *silent_since_ > patience() || now - *waiting_since_ > longest();
    if (!late && stop_requests() == stops_before_) return false;
    shell_.kill();
    return true;
}

Duration RemoteNode::longest() const {
    const double log_s = static_cast<double>(shell_.announced()) / kSlowest_bytes_per_s;
    return patience() + from_seconds(std::min(log_s, to_seconds(kLongestLog)));
}

std::string RemoteNode::log_fault() const {
    if (order_.messages.empty() || !shell_.diverted() || shell_.announced() == shell_.in_file()) return {};
    const std::string advice =
        shell_.fault().empty() ? fmt::format("is there room in {}?", order_.messages.parent_path().string())
                               : fmt::format("that machine {}", shell_.fault());
    return fmt::format("the log of messages of {} came from '{}' with {} of its {} bytes; {}", order_.program,
                       machine_, shell_.in_file(), shell_.announced(), advice);
}

void RemoteNode::save_report() {
    const std::string& said = shell_.said();
    const std::size_t at = said.rfind(kReport);
    if (at == std::string::npos) return;
    const auto flat = [](int depth, auto /*event*/, const auto& /*parsed*/) {
        return depth < kDeepestReport;
    };
    auto report = nlohmann::ordered_json::parse(said.substr(at + kReport.size()), flat, false);
    if (!report.is_object()) return;
    report["machine"] = machine_;
    if (report.contains("log") && report["log"].is_object() && shell_.poll()) {
        report["log"]["file"] = order_.messages.string();
        if (const std::string fault = log_fault(); !fault.empty()) report["log"]["fault"] = fault;
    }
    try {
        write_text_file(order_.report, json_text(report, 2) + '\n');
    } catch (const Error& error) {  // also at the end of this object
        if (!std::exchange(told_report_, true))
            spdlog::error("the report of {}: {}", order_.program, error.what());
    }
}

}  // namespace

RemoteStarter::RemoteStarter(LaunchSettings launch, const std::filesystem::path& session,
                             std::unique_ptr<NodeStarter> here)
    : launch_(std::move(launch)), bundle_(make_bundle(session)), here_(std::move(here)) {}

std::shared_ptr<RunningNode> RemoteStarter::start(const NodeOrder& order) const {
    if (launch_.machine(order.role).empty()) return here_->start(order);
    remove_file(order.log);
    remove_file(order.report);
    if (!order.messages.empty()) remove_file(order.messages);
    return std::make_unique<RemoteNode>(launch_, bundle_, order);
}

namespace {

std::string how_it_failed(const RemoteShell& shell, std::optional<int> code, Duration reach) {
    if (!shell.fault().empty()) return shell.fault();
    return code ? fmt::format("ended with code {}", *code)
                : fmt::format("did not answer within {} s", to_seconds(reach));
}

}  // namespace

MachineVerdict check_machine(const LaunchSettings& launch, Role role, const std::string& program,
                             const std::filesystem::path& log) {
    const std::string& machine = launch.machine(role);
    const std::vector<std::string> command = command_to(launch, machine);
    RemoteShell shell(command, log);
    RemoteOrder order{program, launch.programs, kVersion, machine, "", launch.lease, {}};
    order.only_check = true;
    shell.send(remote_script(order));
    const SessionTime deadline = wall_now() + launch.reach;
    while (!shell.poll() && wall_now() < deadline) wall_sleep(std::chrono::milliseconds{5});
    const auto code = shell.poll();
    if (code == 0 && shell.has_said(kGood)) return {};
    if (!code) shell.kill();
    if (!shell.has_said(kReached)) {
        return {ExitCode::kNetwork,
                fmt::format("cannot reach '{}': '{}' {}: {}", machine, fmt::join(command, " "),
                            how_it_failed(shell, code, launch.reach), shell.last_lines())};
    }
    return {ExitCode::kRunFailed, shell.last_lines()};
}

}  // namespace thimble
