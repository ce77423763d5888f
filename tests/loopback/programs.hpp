// The programs under test, started as users start them, and a look at what the system says about them.
#pragma once

#include <array>
#include <string>
#include <sys/types.h>
#include <vector>

#include "common/process/child.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {

inline constexpr std::array kNodePrograms{"thimble-netem", "thimble-slave-sim", "thimble-cutaneous",
                                          "thimble-visual", "thimble-master"};

std::filesystem::path built_programs();

// A copy of all six in `folder`, in which a test may then replace some: thimble looks for the nodes beside
// itself.
void install_programs(const std::filesystem::path& folder);
void replace_program(const std::filesystem::path& file, const std::string& shell_script);

// All that a program says until it ends, and its exit code; -1 if it does not end.
struct Outcome {
    int code = -1;
    std::string words;
};
Outcome run_to_end(const std::filesystem::path& program, const std::vector<std::string>& arguments);
Outcome run_thimble(const std::vector<std::string>& arguments);

// Node programs that run with this base port, by the name of the program; several if `thimble run` and a test
// both started one.
std::vector<pid_t> node_pids(std::uint16_t base_port, const std::string& program);
// Names of the nodes that run with this base port. A zombie has no command line, and is not among them.
std::vector<std::string> nodes_alive(std::uint16_t base_port);
// Children of a living program that have ended and that it has not waited for.
std::vector<pid_t> zombies_of(pid_t parent);
// Whether there is anything left of a process, also as a zombie, unless only the system's own first process could bury it.
bool is_left_over(pid_t pid);

}  // namespace thimble
