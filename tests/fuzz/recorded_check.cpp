#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <sys/mman.h>
#include <unistd.h>

#include <fmt/format.h>

#include "common/error.hpp"
#include "session/records/trajectory_file.hpp"
#include "session/records/trial_table.hpp"
#include "tests/fuzz/checks.hpp"

namespace thimble {
namespace {

// A file without a disk: the readers take paths.
class MemoryFile {
  public:
    MemoryFile() : descriptor_(memfd_create("recorded.csv", MFD_CLOEXEC)) {}
    ~MemoryFile() { close(descriptor_); }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;

    std::filesystem::path path() const { return fmt::format("/proc/self/fd/{}", descriptor_); }
    void write(std::string_view text) const { std::ofstream(path(), std::ios::binary) << text; }
    std::string text() const {
        std::ifstream in(path(), std::ios::binary);
        return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    }

  private:
    int descriptor_;
};

std::string written_again(const std::vector<TrialRow>& rows, const MemoryFile& file) {
    TrialTable table(file.path(), IfExists::kReplace);
    for (const TrialRow& row : rows) table.append(row);
    return file.text();
}

std::string written_again(const Trajectory& trajectory, const MemoryFile& file) {
    TrajectoryWriter writer(file.path(), IfExists::kReplace);
    writer.append(trajectory.samples);
    writer.end(trajectory.reason, trajectory.lost_peer);
    return file.text();
}

std::string written_again(const std::vector<NetworkEvent>& events, const MemoryFile& file) {
    write_events(file.path(), events);
    return file.text();
}

std::string flaw_of_recorded_refusal(const Error& error, const MemoryFile& file) {
    const std::string_view what = error.what();
    if (error.code() != ExitCode::kData) return fmt::format("an Error that is not about data: {}", what);
    if (!what.starts_with(file.path().string() + ':')) return fmt::format("no file in: {}", what);
    return "";
}

template <class Read>
Verdict check_with(const Read& read, std::string_view text, const char* reader) {
    const MemoryFile file, again;
    file.write(text);
    Verdict verdict;
    try {
        const auto rows = read(file.path());
        verdict.accepted = true;
        const std::string first = written_again(rows, again);
        if (written_again(read(again.path()), file) != first)
            verdict.flaw = "changes when it is written and read again";
    } catch (const Error& error) {
        verdict.flaw = verdict.accepted ? fmt::format("accepted, then refused: {}", error.what())
                                        : flaw_of_recorded_refusal(error, file);
    }
    if (!verdict.flaw.empty()) verdict.flaw = fmt::format("{}: {}", reader, verdict.flaw);
    return verdict;
}

}  // namespace

Verdict check_recorded(Bytes bytes) {
    const std::string_view text = text_of(bytes);
    const Verdict verdicts[]{
        check_with(read_trial_table, text, "trials"),
        check_with([](const auto& path) { return read_trajectory(path); }, text, "trajectory"),
        check_with(read_events, text, "events")};
    Verdict all;
    for (const Verdict& verdict : verdicts) {
        all.accepted = all.accepted || verdict.accepted;
        if (all.flaw.empty()) all.flaw = verdict.flaw;
    }
    return all;
}

}  // namespace thimble
