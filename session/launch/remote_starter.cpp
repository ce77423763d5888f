#include "session/launch/remote_starter.hpp"

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "common/json_text.hpp"
#include "common/runtime/log/message_log.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/text_file.hpp"
#include "common/version.hpp"
#include "session/launch/remote_script.hpp"
#include "session/launch/remote_shell.hpp"

namespace thimble {
namespace {

constexpr Duration kSignOfLife = std::chrono::seconds{1};
// Time for an ending node: the script needs 2 s to kill one that hangs, the rest is for the network.
constexpr Duration kGoodbye = std::chrono::seconds{5};
constexpr Duration kNothingToClean = std::chrono::milliseconds{500};
// The slowest transfer of a log: a network that carries a session is faster.
constexpr double kSlowest_bytes_per_s = 1e5;
constexpr Duration kLongestLog = std::chrono::minutes{10};
constexpr int kDeepestReport = 20;
// Of trials with a log: ten thousand, more than any session has.
constexpr std::size_t kMostNumbers = 20'000;
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
          shell_(command_, order.log),
          log_file_(order.messages) {
        shell_.divert_after(kEnded, [this](const auto& numbers) { return logs_of(numbers); });
        shell_.send(
            remote_script({order.program, launch.programs, kVersion, machine_, bundle.files.front().name,
                           launch.lease, order.arguments, !order.messages.empty(), order.grant_key}));
    }
    ~RemoteNode() override {
        stop();
        while (!output_complete()) wall_sleep(std::chrono::milliseconds{1});
        poll();
        if (!code_) return;
        save_report();  // with what was heard since
    }

    std::optional<int> poll() override {
        if (code_) return code_;
        const auto code = shell_.poll();
        code_ = code;
        // Its node may have ended while its log is still on its way.
        if (const auto& numbers = shell_.diverted(); numbers && !numbers->empty())
            code_ = static_cast<int>(numbers->front());
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
    bool output_complete() override;
    const std::string& program() const override { return order_.program; }
    std::string exit_message() override;
    ExitCode verdict() override {
        return code_ == kNoProgram || code_ == kOtherVersion || code_ == kNoFolder ? ExitCode::kRunFailed
                                                                                   : verdict_on(code_);
    }

  private:
    // Not while older output waits: without a connection the messages would pile up.
    void give_sign_of_life() {
        const SessionTime now = wall_now();
        if (now < next_sign_ || !shell_.all_sent()) return;
        next_sign_ = now + kSignOfLife;
        shell_.send("\n");
    }
    // A signal after the node's end means that the user does not want to wait for its output.
    void note_stop_requests() {
        if (!stops_before_) stops_before_ = stop_requests();
    }
    Duration patience() const { return started_ ? kGoodbye : kNothingToClean; }
    Duration longest() const;
    std::string log_fault() const;
    RemoteShell::Files logs_of(const RemoteShell::Numbers& numbers);
    void save_report();

    NodeOrder order_;
    const SessionBundle& bundle_;
    std::string machine_;
    std::vector<std::string> command_;
    RemoteShell shell_;
    bool started_ = false;
    std::optional<int> code_;
    std::optional<unsigned> stops_before_;
    std::uint64_t heard_ = 0;                                  // bytes, when output_complete() was asked last
    std::optional<SessionTime> waiting_since_, silent_since_;  // of output_complete()
    bool told_report_ = false;                                 // that it cannot be written
    std::filesystem::path log_file_;                           // here, for its report
    std::string cut_off_;                                      // why the rest of its output is not awaited
    SessionTime next_sign_{};
};

std::string RemoteNode::exit_message() {
    const int code = poll().value_or(-1);
    const std::string words = shell_.last_lines();
    if (!shell_.fault().empty()) {
        return fmt::format("lost '{}' while {} ran there: it {}; see what '{}' prints there", machine_,
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

// The whole of its log, as long as that comes, in a time that fits its length. A signal ends the wait.
bool RemoteNode::output_complete() {
    if (shell_.poll()) return true;
    const SessionTime now = wall_now();
    if (!waiting_since_) waiting_since_ = now;
    if (!silent_since_ || heard_ != shell_.heard()) silent_since_ = now;
    heard_ = shell_.heard();
    const bool late = now - *silent_since_ > patience() || now - *waiting_since_ > longest();
    const bool stopped = stop_requests() != stops_before_;
    if (!late && !stopped) return false;
    cut_off_ = stopped ? "a signal ended the wait for the rest" : "the rest did not come in time";
    shell_.kill();
    return true;
}

Duration RemoteNode::longest() const {
    const double log_s = static_cast<double>(shell_.announced()) / kSlowest_bytes_per_s;
    return patience() + from_seconds(std::min(log_s, to_seconds(kLongestLog)));
}

std::string RemoteNode::log_fault() const {
    if (order_.messages.empty() || !shell_.diverted() || shell_.announced() == shell_.in_file()) return {};
    std::string advice = cut_off_;
    if (!shell_.fault().empty())
        advice = fmt::format("that machine {}", shell_.fault());
    else if (advice.empty() && shell_.diverted()->size() > kMostNumbers)
        advice = fmt::format("it has more than {} trials: run fewer at a time", kMostNumbers / 2 - 1);
    else if (advice.empty())
        advice = fmt::format("is there room in {}?", order_.messages.parent_path().string());
    return fmt::format("only part of the message log of {} came from '{}', {} of {} bytes; {}",
                       order_.program, machine_, shell_.in_file(), shell_.announced(), advice);
}

// In lock-step each trial has a log. Their trials and lengths stand behind the exit code.
RemoteShell::Files RemoteNode::logs_of(const RemoteShell::Numbers& numbers) {
    if (order_.messages.empty()) return {};
    if (numbers.size() < 4) return {{order_.messages, numbers.empty() ? 0 : numbers.back()}};
    RemoteShell::Files files;
    std::uint64_t last = 0;
    for (std::size_t i = 1; i + 2 < std::min(numbers.size(), kMostNumbers); i += 2) {
        files.emplace_back(log_path_of_trial(order_.messages, static_cast<unsigned>(numbers[i])),
                           numbers[i + 1]);
        last = std::max(last, numbers[i]);
    }
    log_file_ = log_path_of_trial(order_.messages, static_cast<unsigned>(last));
    return files;
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
        report["log"]["file"] = log_file_.string();
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
