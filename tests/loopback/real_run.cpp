#include "tests/loopback/real_run.hpp"

#include <stdexcept>

#include <fmt/format.h>

namespace thimble {
namespace {

// More than the header and a few lines; the first flush brings some 80 lines.
constexpr std::size_t kSomeSamples = 2000;

std::vector<std::string> run_arguments(const Folder& folder, const SessionFile& session,
                                       const PortBlock& ports, const std::vector<std::string>& more) {
    return words_in(
        fmt::format("run {} --out {} --base-port {}", folder.write("session.toml", session.text()).string(),
                    (folder / "out").string(), ports.base()),
        more);
}

}  // namespace

RealRun::RealRun(const SessionFile& session, const std::vector<std::string>& more_arguments,
                 const std::filesystem::path& programs)
    : child_(programs / "thimble", run_arguments(folder_, session, ports_, more_arguments),
             folder_ / "words") {}

std::string RealRun::first_trajectory() const {
    std::error_code absent;
    for (const auto& file : std::filesystem::directory_iterator(out() / "trajectories", absent)) {
        return read_text(file.path());
    }
    return {};
}

bool RealRun::reaches_trial() {
    wait_until([this] { return first_trajectory().size() > kSomeSamples || child_.poll(); });
    return first_trajectory().size() > kSomeSamples && !child_.poll();
}

pid_t RealRun::node(const std::string& program) const {
    std::vector<pid_t> pids;
    wait_until([&] { return !(pids = node_pids(base_port(), program)).empty(); });
    if (pids.empty()) throw std::runtime_error(program + " is not running: " + words());
    return pids.front();
}

std::string RealRun::first_trial_end() {
    std::string end;
    wait_until([&] {
        const std::string text = first_trajectory();
        const auto comment = text.find("# ");
        if (comment != std::string::npos && text.back() == '\n')
            end = text.substr(comment, text.size() - comment - 1);
        return !end.empty();
    });
    return end;
}

TrialRow RealRun::only_row() const {
    const std::vector<TrialRow> all = rows();
    EXPECT_EQ(all.size(), 1U) << words();
    return all.size() == 1 ? all.front() : TrialRow{};
}

int RealRun::end() { return child_.wait(3 * kPatience).value_or(-1); }

std::filesystem::path RealRun::trajectory_path(const TrialConditions& trial) const {
    return out() / "trajectories" /
           fmt::format("trial{:02}_{}_{:g}ms.csv", trial.trial, to_string(trial.modality),
                       1000 * trial.delay_s);
}

nlohmann::json RealRun::report(const std::string& program, int delay_ms) const {
    const std::string text = read_text(out() / "nodes" / fmt::format("{}_{}ms.json", program, delay_ms));
    return text.empty() ? nlohmann::json() : nlohmann::json::parse(text);
}

}  // namespace thimble
