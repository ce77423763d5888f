// A program started beside this one, its words kept in a log file. Killed, at the latest, when this object
// goes.
#pragma once

#include <filesystem>
#include <optional>
#include <spawn.h>
#include <string>
#include <sys/types.h>
#include <vector>

#include "common/time.hpp"

namespace thimble {

// What the child reads and writes instead of nothing and its log; descriptors of this process.
struct ChildStreams {
    int input = -1, output = -1;  // -1: /dev/null, the log
};

class Child {
  public:
    // A `program` without a slash is sought in PATH. Throws Error (run failed) if it cannot be started.
    Child(const std::filesystem::path& program, const std::vector<std::string>& arguments,
          std::filesystem::path log, ChildStreams streams = {});
    ~Child();
    Child(Child&& other) noexcept;
    Child& operator=(Child&&) = delete;

    // The exit code once it has ended, 128 + n if signal n ended it.
    std::optional<int> poll();
    void signal(int number);
    // To it and all that it started, as far as they did not leave its process group.
    void signal_group(int number);
    // Waits, at most `limit`, for it to end.
    std::optional<int> wait(Duration limit);
    // The last lines it wrote.
    std::string last_words(std::size_t lines = 5) const;
    pid_t pid() const { return pid_; }

  private:
    void direct(posix_spawn_file_actions_t& files, const ChildStreams& streams) const;

    pid_t pid_ = -1;
    std::optional<int> exit_code_;
    std::filesystem::path log_;
};

}  // namespace thimble
