// A program started beside this one, its words kept in a log file. Killed, at the latest, when this object
// goes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

#include "common/time.hpp"

namespace thimble {

class Child {
  public:
    // Throws Error (run failed) if the program cannot be started.
    Child(const std::filesystem::path& program, const std::vector<std::string>& arguments,
          std::filesystem::path log);
    ~Child();
    Child(Child&& other) noexcept;
    Child& operator=(Child&&) = delete;

    // The exit code once it has ended, 128 + n if signal n ended it.
    std::optional<int> poll();
    void signal(int number);
    // Waits, at most `limit`, for it to end.
    std::optional<int> wait(Duration limit);
    // The last lines it wrote.
    std::string last_words(std::size_t lines = 5) const;
    pid_t pid() const { return pid_; }

  private:
    pid_t pid_ = -1;
    std::optional<int> exit_code_;
    std::filesystem::path log_;
};

}  // namespace thimble
