// thimble sweep: a stability map measured in virtual time, with the boundary of the theory.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <unistd.h>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "study/maps/map_options.hpp"
#include "study/study.hpp"
#include "thimble/commands/commands.hpp"

namespace thimble {
namespace {

// Open MPI says to each rank how many there are.
int ranks() {
    const char* count = std::getenv("OMPI_COMM_WORLD_SIZE");
    return count != nullptr ? std::atoi(count) : 0;
}

// This command line, as the program that knows MPI takes it. thimble itself does not load libmpi: it has to run without.
[[noreturn]] void become_a_rank() {
    const auto program = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "thimble-sweep-mpi";
    std::ifstream file("/proc/self/cmdline");
    const std::string typed{std::istreambuf_iterator<char>(file), {}};
    std::vector<std::string> words{program.string()};
    for (std::size_t at = typed.find('\0') + 1; at < typed.size(); at = typed.find('\0', at) + 1)
        words.emplace_back(typed.c_str() + at);
    words.erase(words.begin() + 1);  // "sweep"
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    execv(program.c_str(), arguments.data());
    throw Error(ExitCode::kUsage, fmt::format("mpirun has started {} of this, and {} is missing: build with "
                                              "-DTHIMBLE_MPI=ON, or leave mpirun out "
                                              "(one program uses all cores of its machine)",
                                              ranks(), program.string()));
}

int run_sweep(const SweepArguments& arguments) {
    if (ranks() > 0) become_a_rank();
    install_stop_signals();
    ThreadPool pool(thread_count(arguments.jobs));
    return run_map(arguments, grid_of(arguments), pool);
}

}  // namespace

Subcommand add_sweep(CLI::App& app) {
    const auto arguments = std::make_shared<SweepArguments>();
    CLI::App* command = app.add_subcommand("sweep",
                                           "stability maps: delay against stiffness for hands, compensators "
                                           "and networks, measured and by theory");
    add_sweep_options(*command, *arguments);
    return {command, [arguments] { return run_sweep(*arguments); }};
}

}  // namespace thimble
