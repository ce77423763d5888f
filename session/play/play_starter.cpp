#include "session/play/play_starter.hpp"

#include <cstdlib>
#include <string>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/process/child.hpp"

namespace thimble {
namespace {

const std::vector<std::string> kWindow{"--window", "--view", "player"};
constexpr Duration kHelpWithin = std::chrono::seconds{5};

bool has_text(const char* variable) {
    const char* value = std::getenv(variable);  // NOLINT(concurrency-mt-unsafe): nobody sets it
    return value != nullptr && *value != '\0';
}

}  // namespace

PlayStarter::PlayStarter(std::filesystem::path programs, std::filesystem::path config,
                         std::vector<std::string> visual_command, bool pointer)
    : local_(std::move(programs), std::move(config)),
      visual_command_(std::move(visual_command)),
      pointer_(pointer) {}

std::shared_ptr<RunningNode> PlayStarter::start(const NodeOrder& order) const {
    NodeOrder mine = order;
    if (order.role == Role::kMaster && pointer_) mine.arguments.emplace_back("--pointer");
    if (order.role != Role::kVisual) return local_.start(mine);
    if (visual_command_.empty()) {
        mine.arguments.insert(mine.arguments.end(), kWindow.begin(), kWindow.end());
    } else {
        mine.program = visual_command_.front();
        mine.arguments.insert(mine.arguments.end(), visual_command_.begin() + 1, visual_command_.end());
    }
    auto window = local_.start(mine);
    window_ = window;
    return window;
}

bool PlayStarter::window_closed() const {
    const auto window = window_.lock();
    return window && window->poll() == static_cast<int>(ExitCode::kOk);
}

void check_window(const std::filesystem::path& programs) {
    const auto words = std::filesystem::temp_directory_path() / fmt::format("thimble_help_{}", ::getpid());
    std::string help;
    {
        Child child(programs / "thimble-visual", {"--help"}, words);
        child.wait(kHelpWithin);
        help = child.last_lines(1000);
    }
    std::error_code ignored;
    std::filesystem::remove(words, ignored);
    if (help.find("--window") == std::string::npos) {
        throw Error(ExitCode::kUsage,
                    "{} was built without a window: install the packages that docs/play.md names, configure "
                    "and build again",
                    (programs / "thimble-visual").string());
    }
    if (has_text("DISPLAY") || has_text("WAYLAND_DISPLAY")) return;
    throw Error(ExitCode::kUsage,
                "there is no screen here: neither DISPLAY nor WAYLAND_DISPLAY is set. Start it from a "
                "desktop, or over `ssh -X`, or give it one: xvfb-run -a thimble ...");
}

ScratchFolder::ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "thimble_play_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
        throw Error(ExitCode::kRunFailed,
                    "cannot make a folder for logs at {}: set TMPDIR to one that can be written to", name);
    }
    path_ = name;
}

ScratchFolder::~ScratchFolder() {
    if (kept_) return;
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

}  // namespace thimble
