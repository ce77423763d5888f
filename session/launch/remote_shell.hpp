// The launcher's end of a shell on another machine: bytes to its standard input as fast as it takes them, lines from its
// standard output, its standard error in a log. Never blocks. The program must ignore SIGPIPE: the other end may go at any
// time. The other end may say anything: output, log and file have limits, and a shell that goes beyond them is killed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "common/process/child.hpp"

namespace thimble {

class RemoteShell : boost::noncopyable {
  public:
    // `command`: what gets a shell there, its words. Throws Error (run failed) if it cannot be started.
    RemoteShell(const std::vector<std::string>& command, const std::filesystem::path& log);
    ~RemoteShell();

    void send(std::string_view bytes) { pending_ += bytes; }
    bool all_sent() const { return pending_.empty(); }
    // The end of its input, which tells it to end.
    void hang_up();
    // Moves what can be moved; the exit code once the command has ended and all that it said is here.
    std::optional<int> poll();
    // All its output so far, and whether this line is in it.
    const std::string& said() const { return said_; }
    bool has_said(std::string_view line) const;
    std::string last_lines() const { return child_.last_lines(); }
    // From the first line on that begins with this word its output goes to new files, and no more to said(). `files_of` gives
    // them, and their lengths, for the numbers of that line. The last number is the length of all.
    using Numbers = std::vector<std::uint64_t>;
    using Files = std::vector<std::pair<std::filesystem::path, std::uint64_t>>;
    void divert_after(std::string_view word, std::function<Files(const Numbers&)> files_of);
    // The numbers, once they have come. The length. The bytes of the files that came and could be written.
    const std::optional<Numbers>& diverted() const { return diverted_; }
    std::uint64_t announced() const { return announced_; }
    std::uint64_t in_file() const { return in_file_; }
    std::uint64_t heard() const { return heard_; }  // bytes in all
    // Which limit the other end did not keep, in words that follow its name; empty: none.
    const std::string& fault() const { return fault_; }
    // Kills the command, for one that does not end after hang_up(), and waits for it.
    void kill();

  private:
    struct Pipes;
    RemoteShell(const std::vector<std::string>& command, const std::filesystem::path& log, Pipes&& pipes);
    void feed();
    template <class Use>
    static void hear(int from, Use&& use);
    void take(std::string_view bytes);
    void keep(std::string_view bytes);
    void keep_words(std::string_view bytes);
    void look_for_turn();
    void expect_files(const Numbers& numbers);

    Child child_;
    int input_, output_, error_;
    std::ofstream log_;
    std::size_t logged_ = 0;
    std::string pending_, said_, fault_;
    std::string turn_;  // the word; empty: none, or it has come
    std::optional<Numbers> diverted_;
    std::function<Files(const Numbers&)> files_of_;
    Files files_;  // with the bytes that each still lacks
    std::size_t at_ = 0;
    std::ofstream file_;
    std::uint64_t heard_ = 0, announced_ = 0, came_ = 0, in_file_ = 0;
    std::uint64_t counted_ = 0;  // of the file, in the sum of all
};

}  // namespace thimble
