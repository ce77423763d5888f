// main() of a node, minus what makes it that node: command line, configuration, signals, loop, report.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/config.hpp"
#include "common/histogram.hpp"
#include "common/node_process.hpp"
#include "common/runtime/sockets.hpp"

namespace thimble {

// A node with everything it owns (devices, process), built for this program's life.
class NodeInstance {
  public:
    virtual ~NodeInstance() = default;
    virtual NodeProcess& process() = 0;
    // What the node wants to say in its report besides counters and lateness.
    virtual void describe(nlohmann::ordered_json& /*report*/) const {}
};

struct NumberOption {
    std::string flag, help;
    double* target;
    double low, high;
};

struct FlagOption {
    std::string flag, help;
    bool* target;
};

struct NodeProgram {
    std::string name, description, example;
    std::vector<NumberOption> options;
    std::vector<FlagOption> flags{};
    // Reads the node's tables and opens its channels. The program checks the file for unknown keys
    // afterwards; `tables` are the ones this node reads itself.
    std::vector<std::string_view> tables;
    std::function<std::unique_ptr<NodeInstance>(const ConfigFile&, Sockets&, std::uint64_t instance)> build;
};

// For a report: median_us, p99_us, worst_us, count.
nlohmann::ordered_json quantiles(const Histogram& histogram);

// Runs until SIGINT, SIGTERM or a shutdown from the session; returns the exit code.
int run_node_program(const NodeProgram& program, int argc, char** argv);

// Calls `body`, turning Error and other exceptions into a message on stderr and an exit code.
int guarded_main(const std::string& name, const std::function<int()>& body);

}  // namespace thimble
