// Starts nodes on other machines: a command (ssh, `ip netns exec`, ...) opens a shell there, which runs our script
// (remote_script.hpp). Nodes of this machine are child processes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "session/launch/node_starter.hpp"
#include "session/settings/launch_settings.hpp"

namespace thimble {

// A session file with every file that it names: what a node on another machine needs to read the same settings.
struct BundledFile {
    std::string name;  // relative, in the folder of the session file; '/' between folders
    std::string text;
};

struct SessionBundle {
    std::vector<BundledFile> files;  // the session file first
};

// Reads them all. Throws Error (usage) if the session file cannot be read with the others from its own folder alone:
// a name that is absolute, leads out of the folder, or was found elsewhere.
SessionBundle make_bundle(const std::filesystem::path& session);

// How it is sent: for each file a line "SIZE NAME" and SIZE bytes, then the line "end".
std::string to_stream(const SessionBundle& bundle);

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

// Result of check_machine(): is the program there, in this program's version? It is not started.
struct MachineVerdict {
    ExitCode code = ExitCode::kOk;
    std::string problem;
};
MachineVerdict check_machine(const LaunchSettings& launch, Role role, const std::string& program,
                             const std::filesystem::path& log);

}  // namespace thimble
