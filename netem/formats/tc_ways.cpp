// Assigns the netem of each device to a direction, and combines both directions.
#include <utility>

#include <fmt/format.h>

#include "common/error.hpp"
#include "netem/formats/jitter_table_file.hpp"
#include "netem/formats/tc_command.hpp"
#include "netem/formats/tc_text.hpp"
#include "netem/formats/text_lines.hpp"

namespace thimble {
namespace {

// Reads the options of one device.
LinkSettings read_device(const TcQdisc& qdisc, const TableFinder& find_table, bool& both, TcWays& ways) {
    TcLink tc = parse_netem_words(qdisc, find_table);
    both = tc.both;
    ways.notes.insert(ways.notes.end(), tc.notes.begin(), tc.notes.end());
    if (tc.seed) ways.seed = tc.seed;
    return tc.link;
}

void read_known_way(const TcQdisc& qdisc, const TableFinder& find_table, Way known, TcWays& ways) {
    bool both = false;
    (known == Way::kUp ? ways.up : ways.down) = read_device(qdisc, find_table, both, ways);
    if (both) throw Error(ExitCode::kUsage, "tc words: `both` contradicts an option for one way");
    ways.one_way = true;
}

void read_one_device(const TcQdisc& qdisc, const TableFinder& find_table, TcWays& ways) {
    bool both = false;
    const LinkSettings link = read_device(qdisc, find_table, both, ways);
    const bool incoming = qdisc.incoming() && !both;
    if (!incoming) ways.up = link;
    if (incoming || both) ways.down = link;
    ways.one_way = !incoming && !both;
    if (incoming) ways.notes.push_back(fmt::format("dev {} receives: it is the way down only", qdisc.device));
    if (ways.one_way)
        ways.notes.emplace_back(
            "tc's words are for packets that leave a device, the way up only; add `both` for the way down as "
            "well");
}

void read_two_devices(std::vector<TcQdisc>& qdiscs, const TableFinder& find_table, TcWays& ways) {
    if (qdiscs[0].incoming() && !qdiscs[1].incoming()) std::swap(qdiscs[0], qdiscs[1]);
    bool both_up = false, both_down = false;
    ways.up = read_device(qdiscs[0], find_table, both_up, ways);
    ways.down = read_device(qdiscs[1], find_table, both_down, ways);
    if (both_up || both_down) throw Error(ExitCode::kUsage, "tc words: `both` contradicts two devices");
    ways.notes.push_back(
        fmt::format("dev {} is the way up, dev {} the way down", qdiscs[0].device, qdiscs[1].device));
}

}  // namespace

TcWays parse_tc(std::string_view text, const TableFinder& find_table, std::optional<Way> known) {
    TcWays ways;
    if (trimmed(text).empty()) {
        ways.one_way = true;
        return ways;
    }
    TcText commands = read_tc_text(text);
    ways.notes = std::move(commands.notes);
    const std::size_t most = known ? 1 : 2;
    if (commands.qdiscs.size() > most) {
        throw Error(ExitCode::kUsage, "tc words: netem at {} devices, but {}", commands.qdiscs.size(),
                    known ? "the option is for one way: give those of one"
                          : "a path has two ways: give those of two");
    }
    if (known) {
        read_known_way(commands.qdiscs.front(), find_table, *known, ways);
    } else if (commands.qdiscs.size() == 2) {
        read_two_devices(commands.qdiscs, find_table, ways);
    } else {
        read_one_device(commands.qdiscs.front(), find_table, ways);
    }
    return ways;
}

TcWays parse_tc(std::string_view text, std::optional<Way> known) {
    return parse_tc(text, find_jitter_table, known);
}

}  // namespace thimble
