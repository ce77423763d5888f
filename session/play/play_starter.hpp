// The five nodes as `thimble play` starts them: the master with a pointer's handle, thimble-visual with a window, or a
// program that a test puts in its place.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "session/launch/node_starter.hpp"

namespace thimble {

class PlayStarter final : public NodeStarter {
  public:
    // `visual_command`: program and arguments instead of thimble-visual's window; empty: the window. `pointer`: the window's
    // pointer is the hand, else the session file's [handle] says what is.
    PlayStarter(std::filesystem::path programs, std::filesystem::path config,
                std::vector<std::string> visual_command, bool pointer = true);

    std::shared_ptr<RunningNode> start(const NodeOrder& order) const override;
    Duration reach() const override { return local_.reach(); }
    std::string machine(Role role) const override { return local_.machine(role); }

    // The user has closed the window: its program has ended with exit code 0.
    bool window_closed() const;

  private:
    LocalStarter local_;
    std::vector<std::string> visual_command_;
    bool pointer_;
    mutable std::weak_ptr<RunningNode> window_;  // the condition's run owns it
};

// A window needs a screen and a thimble-visual that can open one. Throws Error (usage) that says which is missing.
void check_window(const std::filesystem::path& programs);

// A folder for logs: gone with this object, unless they are kept.
class ScratchFolder : boost::noncopyable {
  public:
    // Throws Error (run failed) if the system's folder for such things cannot be written to.
    ScratchFolder();
    ~ScratchFolder();
    const std::filesystem::path& path() const { return path_; }
    void keep() { kept_ = true; }

  private:
    std::filesystem::path path_;
    bool kept_ = false;
};

}  // namespace thimble
