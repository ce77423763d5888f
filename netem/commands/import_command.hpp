// thimble-netem import: what a measuring program wrote becomes a trace.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace thimble {

struct ImportArguments {
    std::vector<std::string> files;  // one of irtt or ping, or two captures: sender's, receiver's
    std::string out;
    std::string format = "auto";     // irtt, ping, pcap; auto: by what the first file begins with
    std::string direction = "both";  // of irtt: up, down; both: OUT.up.csv and OUT.down.csv
    double interval_s = 1;           // of ping without time stamps
    int sent_port = 0, received_port = 0;
    double least_delay_s = -1;  // below 0: as the stamps are
};

// Writes the trace, says on stdout what is in it. Throws Error.
int import_command(const ImportArguments& arguments);

// Adds the subcommand. The function is what it does once the command line has been parsed; it returns the exit code.
std::pair<CLI::App*, std::function<int()>> add_import(CLI::App& app);

}  // namespace thimble
