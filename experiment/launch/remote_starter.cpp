#include "experiment/launch/remote_starter.hpp"

#include <csignal>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "common/runtime/wall_clock.hpp"
#include "common/text_file.hpp"
#include "common/version.hpp"
#include "experiment/launch/remote_script.hpp"
#include "experiment/launch/remote_shell.hpp"

namespace thimble {
namespace {

constexpr Duration kSignOfLife = std::chrono::seconds{1};
// The script needs two to kill a node that hangs; the rest is the way there and back.
constexpr Duration kGoodbye = std::chrono::seconds{5};
constexpr Duration kNothingToClean = std::chrono::milliseconds{500};
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
        shell_.send(remote_script({order.program, launch.programs, kVersion, machine_,
                                   bundle.files.front().name, launch.lease, order.arguments}));
    }
    ~RemoteNode() override {
        stop();
        if (!wait_for_end(*this, started_ ? kGoodbye : kNothingToClean)) shell_.kill();
    }

    std::optional<int> poll() override {
        const auto code = shell_.poll();
        if (code && !code_) save_report();
        if (code) return code_ = code;
        if (!started_ && shell_.has_said(kSend)) {
            shell_.send(to_stream(bundle_));
            started_ = true;
        }
        if (started_) give_sign_of_life();
        return std::nullopt;
    }
    bool started() const override { return started_ && shell_.all_sent(); }
    void stop() override { shell_.hang_up(); }
    std::string obituary() override;
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
    void save_report();

    NodeOrder order_;
    const SessionBundle& bundle_;
    std::string machine_;
    std::vector<std::string> command_;
    RemoteShell shell_;
    bool started_ = false;
    std::optional<int> code_;
    SessionTime next_sign_{};
};

std::string RemoteNode::obituary() {
    const int code = poll().value_or(-1);
    const std::string words = shell_.last_words();
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

void RemoteNode::save_report() {
    const std::string& said = shell_.said();
    const std::size_t at = said.rfind(kReport);
    if (at == std::string::npos) return;
    auto report = nlohmann::ordered_json::parse(said.substr(at + kReport.size()), nullptr, false);
    if (!report.is_object()) return;
    report["machine"] = machine_;
    write_text_file(order_.report, report.dump(2) + '\n');
}

}  // namespace

RemoteStarter::RemoteStarter(LaunchSettings launch, const std::filesystem::path& session,
                             std::unique_ptr<NodeStarter> here)
    : launch_(std::move(launch)), bundle_(make_bundle(session)), here_(std::move(here)) {}

std::unique_ptr<RunningNode> RemoteStarter::start(const NodeOrder& order) const {
    if (launch_.machine(order.role).empty()) return here_->start(order);
    std::filesystem::remove(order.log);
    std::filesystem::remove(order.report);
    return std::make_unique<RemoteNode>(launch_, bundle_, order);
}

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
                            code ? fmt::format("ended with code {}", *code)
                                 : fmt::format("did not answer within {} s", to_seconds(launch.reach)),
                            shell.last_words())};
    }
    return {ExitCode::kRunFailed, shell.last_words()};
}

}  // namespace thimble
