// Nodes on other machines: a command (ssh, `ip netns exec`, ...) opens a shell there, which runs our script (remote_script.hpp). Nodes whose machine is this one are children, as ever.
#pragma once

#include "session/launch/node_starter.hpp"
#include "session/launch/session_bundle.hpp"
#include "session/settings/launch_settings.hpp"

namespace thimble {

class RemoteStarter final : public NodeStarter {
  public:
    // `here` starts what runs on this machine. Throws Error (usage) as make_bundle does.
    RemoteStarter(LaunchSettings launch, const std::filesystem::path& session,
                  std::unique_ptr<NodeStarter> here);

    std::shared_ptr<RunningNode> start(const NodeOrder& order) const override;
    Duration reach() const override { return launch_.reach; }
    std::string machine(Role role) const override { return launch_.machine(role); }

  private:
    LaunchSettings launch_;
    SessionBundle bundle_;
    std::unique_ptr<NodeStarter> here_;
};

// Whether a program is there, with this program's version, without starting it: "" or what is wrong. Its words go to
// `log`, a new file.
struct MachineVerdict {
    ExitCode code = ExitCode::kOk;
    std::string problem;
};
MachineVerdict check_machine(const LaunchSettings& launch, Role role, const std::string& program,
                             const std::filesystem::path& log);

}  // namespace thimble
