// The five nodes as `thimble play` starts them: the master with a pointer's handle, thimble-visual with a window, or a
// program that a test puts in its place.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "common/error.hpp"
#include "common/own_program.hpp"
#include "common/process/child.hpp"
#include "session/launch/node_starter.hpp"

namespace thimble {

inline constexpr Duration kHelpWithin = std::chrono::seconds{5};

class PlayStarter final : public NodeStarter {
  public:
    // `visual_command`: program and arguments instead of thimble-visual's window; empty: the window. `pointer`: the window's
    // pointer is the hand, else the session file's [handle] says what is. `scene`: of the window.
    PlayStarter(std::filesystem::path programs, std::filesystem::path config,
                std::vector<std::string> visual_command, bool pointer = true, std::string scene = "cutaway")
        : local_(std::move(programs), std::move(config)),
          visual_command_(std::move(visual_command)),
          scene_(std::move(scene)),
          pointer_(pointer) {}

    std::shared_ptr<RunningNode> start(const NodeOrder& order) const override {
        NodeOrder mine = order;
        if (order.role == Role::kMaster && pointer_) mine.arguments.emplace_back("--pointer");
        if (order.role != Role::kVisual) return local_.start(mine);
        if (visual_command_.empty()) {
            for (const char* word : {"--window", "--role", "player", "--view", scene_.c_str()})
                mine.arguments.emplace_back(word);
        } else {
            mine.program = visual_command_.front();
            mine.arguments.insert(mine.arguments.end(), visual_command_.begin() + 1, visual_command_.end());
        }
        auto window = local_.start(mine);
        window_ = window;
        return window;
    }

    Duration reach() const override { return local_.reach(); }
    std::string machine(Role role) const override { return local_.machine(role); }

    // The user has closed the window: its program has ended with exit code 0.
    bool window_closed() const {
        const auto window = window_.lock();
        return window && window->poll() == static_cast<int>(ExitCode::kOk);
    }

  private:
    LocalStarter local_;
    std::vector<std::string> visual_command_;
    std::string scene_;
    bool pointer_;
    mutable std::weak_ptr<RunningNode> window_;  // the condition's run owns it
};

// A folder for logs: gone with this object, unless they are kept.
class ScratchFolder : boost::noncopyable {
  public:
    // Throws Error (run failed) if the system's folder for such things cannot be written to.
    ScratchFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "thimble_play_XXXXXX").string();
        if (::mkdtemp(name.data()) == nullptr) {
            throw Error(ExitCode::kRunFailed,
                        "cannot make a folder for logs at {}: set TMPDIR to a folder that you can write to",
                        name);
        }
        path_ = name;
    }

    ~ScratchFolder() {
        if (kept_) return;
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }

    const std::filesystem::path& path() const { return path_; }
    void keep() { kept_ = true; }

  private:
    std::filesystem::path path_;
    bool kept_ = false;
};

// A window needs a screen and a thimble-visual that can open one. Throws Error (usage) that says which is missing.
inline void check_window(const std::filesystem::path& programs) {
    const ScratchFolder scratch;
    Child child(programs / "thimble-visual", {"--help"}, scratch.path() / "help");
    child.wait(kHelpWithin);
    const std::string help = child.last_lines(1000);
    if (help.find("--window") == std::string::npos) {
        throw Error(
            ExitCode::kUsage,
            "{} was built without a window: run deploy/install-packages build programs, configure and "
            "build again, or use the page: thimble play --browser",
            (programs / "thimble-visual").string());
    }
    if (!environment_text("DISPLAY").empty() || !environment_text("WAYLAND_DISPLAY").empty()) return;
    throw Error(
        ExitCode::kUsage,
        "there is no screen: neither DISPLAY nor WAYLAND_DISPLAY is set. Start the program from a desktop, "
        "over `ssh -X`, or under xvfb-run -a. A browser needs no screen here: thimble play --browser");
}

}  // namespace thimble
