// A program started beside this one, its words kept in a log file. Killed, at the latest, when this object
// goes. And one that is run to its end.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <spawn.h>
#include <string>
#include <sys/types.h>
#include <vector>

#include "common/text_file.hpp"
#include "common/time.hpp"

namespace thimble {

// Descriptors of this process that the child reads and writes instead of /dev/null and its log.
struct ChildStreams {
    int input = -1, output = -1, error = -1;  // -1: /dev/null, the log, the log
};

// The child's folder, and advice for a user who lacks the program.
struct ChildPlace {
    std::filesystem::path directory{};  // empty: this one
    std::string remedy = "is Thimble built or installed completely?";
};

class Child {
  public:
    // A `program` without a slash is sought in PATH. Throws Error (run failed) if it cannot be started.
    Child(const std::filesystem::path& program, const std::vector<std::string>& arguments,
          std::filesystem::path log, ChildStreams streams = {}, const ChildPlace& place = {});
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
    int wait_for_ever();
    // The last lines in its log, each of a length that a person reads, without control characters.
    std::string last_lines(std::size_t lines = 5) const;
    pid_t pid() const { return pid_; }

  private:
    void direct(posix_spawn_file_actions_t& files, const ChildStreams& streams,
                const ChildPlace& place) const;

    pid_t pid_ = -1;
    std::optional<int> exit_code_;
    std::filesystem::path log_;
    std::shared_ptr<FileDescriptor> words_;  // the log, also where this program may open no more
};

struct ProgramResult {
    int exit_code = 0;   // 128 + signal if a signal ended it
    std::string output;  // stdout and stderr, as they came
};

// Runs another program in `directory` to its end and keeps what it said. Searches PATH, stdin is empty. Throws Error (run failed)
// if the program cannot be started; `remedy` completes that message ("install ...").
ProgramResult run_program(const std::string& program, const std::vector<std::string>& arguments,
                          const std::filesystem::path& directory, const std::string& remedy);

}  // namespace thimble
