// The launcher's end of a shell on another machine: bytes to its standard input as fast as it takes them, lines from its
// standard output, its standard error in a log. Never blocks. The program must ignore SIGPIPE: the other end may go at any
// time.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/child.hpp"

namespace thimble {

class RemoteShell {
  public:
    // `command`: what gets a shell there, its words. Throws Error (run failed) if it cannot be started.
    RemoteShell(const std::vector<std::string>& command, const std::filesystem::path& log);
    ~RemoteShell();
    RemoteShell(const RemoteShell&) = delete;
    RemoteShell& operator=(const RemoteShell&) = delete;

    void send(std::string_view bytes) { pending_ += bytes; }
    bool all_sent() const { return pending_.empty(); }
    // The end of its input, which tells it to end.
    void hang_up();
    // Moves what can be moved; the exit code once the command has ended and all that it said is here.
    std::optional<int> poll();
    // Everything it said so far, and whether that has this line.
    const std::string& said() const { return said_; }
    bool has_said(std::string_view line) const;
    std::string last_words() const { return child_.last_words(); }
    // Kills the command, for one that does not end after hang_up(), and waits for it.
    void kill();

  private:
    struct Pipes;
    RemoteShell(const std::vector<std::string>& command, const std::filesystem::path& log, Pipes&& pipes);
    void feed();
    void hear();

    Child child_;
    int input_, output_;
    std::string pending_, said_;
};

}  // namespace thimble
