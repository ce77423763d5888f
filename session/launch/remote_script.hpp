// The script that starts a node on another machine. Any POSIX sh with coreutils or busybox runs it. It
// goes to the standard input of `sh`, so that no login shell on the way has to understand a quote, and talks with the
// launcher over the same pipes:
//
//     here                          there
//     the script                    looks for the program and its version
//                                   stdout: kReached, then kSend
//     the bundle (session_bundle)   unpacks it in a folder of its own, starts the node
//     a line, once a second         lives as long as these come: none for `lease`, or the end of the input, ends
//                                   the node with SIGTERM, after two seconds with SIGKILL
//     reads to the end              stderr: the node's words. At its end stdout: kReport and its report (JSON). Then kEnded and
//                                   its exit code, in lock-step the trial and the length of each log of messages, and
//                                   the length of all logs. Then the logs. The folder is removed. Exit code: the node's
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/time.hpp"

namespace thimble {

// One word that the shell takes as it is, whatever it holds (but no NUL).
std::string shell_word(std::string_view text);
// Several, with blanks between.
std::string shell_words(const std::vector<std::string>& words);

inline constexpr std::string_view kReached = "thimble: reached";  // lines of their own
inline constexpr std::string_view kSend = "thimble: send";
inline constexpr std::string_view kReport = "thimble: report";
inline constexpr std::string_view kEnded = "thimble: ended";  // and numbers
inline constexpr std::string_view kGood = "thimble: good";

// Exit codes of the script itself, apart from those of nodes (0 to 5, 128 + signal) and of ssh (255).
inline constexpr int kNoProgram = 96, kOtherVersion = 97, kNoFolder = 98;

struct RemoteOrder {
    std::string program;  // "thimble-master"
    std::string folder;   // of the program there; empty: PATH
    std::string version;  // which it must have
    std::string machine;  // as the session file calls it, for messages
    std::string session;  // name of the session file in the bundle
    Duration lease{};
    std::vector<std::string> arguments;
    bool messages = false;    // whether it writes logs of messages, to be sent here
    std::string grant_key{};  // of lock-step; empty: by the wall clock
    bool only_check = false;  // says kGood instead of starting anything
};

std::string remote_script(const RemoteOrder& order);

}  // namespace thimble
