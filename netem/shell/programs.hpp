// The one or two programs of a shell or pair: their signals, their ends, their exit codes.
#pragma once

#include <memory>
#include <optional>
#include <sys/signalfd.h>
#include <sys/types.h>
#include <vector>

#include "common/time.hpp"
#include "netem/shell/program_room.hpp"

namespace thimble {

// Signals that come to this process go on to its programs. Blocks them, so make it before any thread.
class SignalLine : boost::noncopyable {
  public:
    SignalLine();
    ~SignalLine();
    int descriptor() const { return descriptor_; }
    std::optional<signalfd_siginfo> next();

  private:
    int descriptor_;
};

class Programs {
  public:
    // Of a pair all end when one has ended, or at Ctrl-C. `spared`: a child of this process that has a waiter of its own.
    explicit Programs(std::vector<std::unique_ptr<ProgramRoom>> rooms, pid_t spared = -1)
        : rooms_(std::move(rooms)), spared_(spared) {
        codes_.resize(rooms_.size());
    }
    const ProgramRoom& room(std::size_t i) const { return *rooms_[i]; }
    void start(std::size_t i, const Environment& environment) { rooms_[i]->start(environment); }

    void obey(const signalfd_siginfo& signal, SessionTime now);
    // Takes note of what has ended, and ends the rest of a pair in its time.
    void look(SessionTime now);
    bool all_ended() const;
    // 128 + n for signal n. Of a pair the first that is not 0; one that was asked to end because the other had does not count.
    int exit_code() const { return exit_code_; }

  private:
    void signal_all(int number);
    void reap_orphans() const;
    void note_end(std::size_t program, int status, SessionTime now);

    std::vector<std::unique_ptr<ProgramRoom>> rooms_;
    pid_t spared_;
    std::vector<std::optional<int>> codes_;
    int exit_code_ = 0, asked_ = 0;
    int asked_code_ = 0;                              // of the signal that asked for the end
    SessionTime ask_at_ = kNever, kill_at_ = kNever;  // the rest of a pair
};

// Ends whatever a program has left behind: its children, also those that have cut themselves off.

// From now on orphans below this process become its children.
void adopt_orphans();

// To all processes below this one but `spared`.
void signal_descendants(int number, pid_t spared);

// All processes below this one but `spared`: first SIGTERM, after a second SIGKILL, until there are none.
void end_descendants(pid_t spared);

}  // namespace thimble
