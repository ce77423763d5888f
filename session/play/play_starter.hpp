// The five nodes as `thimble play` starts them: the master with a pointer's handle, thimble-visual with a window, or a
// program that a test puts in its place.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "session/launch/local_starter.hpp"

namespace thimble {

class PlayStarter final : public NodeStarter {
  public:
    // `visual_command`: program and arguments instead of thimble-visual's window; empty: the window. `pointer`: the window's
    // pointer is the hand, else the session file's [handle] says what is.
    PlayStarter(std::filesystem::path programs, std::filesystem::path config,
                std::vector<std::string> visual_command, bool pointer = true);

    std::unique_ptr<RunningNode> start(const NodeOrder& order) const override;
    Duration reach() const override { return local_.reach(); }
    std::string machine(Role role) const override { return local_.machine(role); }

    // The user has closed the window: its program has ended with exit code 0.
    bool window_closed() const;

  private:
    LocalStarter local_;
    std::vector<std::string> visual_command_;
    bool pointer_;
    mutable std::weak_ptr<RunningNode> window_;
};

// A window needs a screen and a thimble-visual that can open one. Throws Error (usage) that says which is missing.
void check_window(const std::filesystem::path& programs);

}  // namespace thimble
