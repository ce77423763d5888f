#include "bench/network/study_place.hpp"

#include <cstdlib>
#include <thread>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/runtime/realtime_loop.hpp"

namespace thimble {
namespace {

// On a thread of its own: this program itself is no node.
bool is_granted(const RuntimeSettings& runtime) {
    std::string refusal;
    std::thread([&] { refusal = ask_for_realtime(runtime); }).join();
    if (!refusal.empty()) spdlog::warn(refusal);
    return refusal.empty();
}

}  // namespace

Scratch::Scratch() {
    std::string name = (std::filesystem::temp_directory_path() / "thimble_bench_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
        throw Error(ExitCode::kData, fmt::format("cannot make a folder like '{}': set TMPDIR", name));
    path_ = name;
}

Scratch::~Scratch() {
    std::error_code left;
    std::filesystem::remove_all(path_, left);
}

std::filesystem::path own_folder() { return std::filesystem::read_symlink("/proc/self/exe").parent_path(); }

std::vector<bool> schedulings(const std::string& wanted) {
    std::vector<bool> realtime;
    if (wanted != "default" && is_granted({})) realtime.push_back(true);
    if (wanted != "fifo") realtime.push_back(false);
    if (realtime.empty())
        throw Error(ExitCode::kRealtime, "SCHED_FIFO is not allowed here: leave --scheduling fifo out");
    return realtime;
}

}  // namespace thimble
