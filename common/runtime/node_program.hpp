// main() of a node, minus what makes it that node: command line, configuration, signals, loop, report.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/config.hpp"
#include "common/histogram.hpp"
#include "common/node_process.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/sockets.hpp"
#include "common/time.hpp"

namespace thimble {

// A node with everything it owns (devices, process), built for this program's life.
class NodeInstance {
  public:
    virtual ~NodeInstance() = default;
    virtual NodeProcess& process() = 0;
    // Brings its devices up before the node says that it is ready, with time limits of its own. Throws Error with which device,
    // which step, why and what to do.
    virtual void bring_up() {}
    // Takes the force off its device, in another thread, when a plug-in does not come back. Empty: there is no force.
    virtual std::function<void()> rest_without_plugin() { return {}; }
    // The node's own part of its report, besides counters and lateness.
    virtual void describe(nlohmann::ordered_json& /*report*/) const {}
    // A node with work that only the program's main thread may do (a window): its process then runs in a second thread, and
    // this in the main one. Returns when `stopped` says true, or before: the process goes on without.
    virtual bool has_foreground() const { return false; }
    virtual void foreground(const std::function<bool()>& /*stopped*/) {}
};

struct NodeProgram {
    std::string name, description, example;
    std::function<void(CLI::App&)> add_options;  // the node's own, besides those of every program
    std::vector<std::string_view> tables;        // those this node reads itself
    // Reads them, so that all that is wrong with them is said before `build` opens a device.
    std::function<void(const ConfigFile&)> read;
    // It hands datagrams on, and does not read them: of a session's log it keeps its own orders and heartbeats only.
    bool relays = false;
    // Reads the node's tables once more and opens its channels.
    std::function<std::unique_ptr<NodeInstance>(const ConfigFile&, Sockets&, std::uint64_t instance)> build;
};

// Runs until SIGINT, SIGTERM or a shutdown from the session; returns the exit code.
int run_node_program(const NodeProgram& program, int argc, char** argv);

// Median, 99 % and worst in microseconds, and the count.
nlohmann::ordered_json quantiles(const Histogram& histogram);

// Every main() calls this. It opens the standard descriptors and calls `body`. It turns Error and other exceptions into a message
// on stderr and an exit code.
int guarded_main(const std::string& name, const std::function<int()>& body);

// Until awaits() is empty. It says what is still to do, which is logged each time that it changes. `key`: of the
// session file, for the limit; empty: none. Throws Error (run failed) after `limit`, or when the program is to stop.
void await_user(const std::function<std::string()>& awaits, Duration limit, std::string_view key = {});

}  // namespace thimble
