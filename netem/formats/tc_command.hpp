// Finds the netem options in shell text: in tc command lines ("sudo tc qdisc add dev eth0 root netem delay 50ms &&
// ..."), in the output of `tc qdisc show`, or alone. It only splits and sorts; tc_text.hpp reads the options.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace thimble {

// The netem qdisc that holds at a device once all commands have been carried out.
struct TcQdisc {
    std::string
        device{};  // with the words before tc that say where: "ip netns exec h1 eth0"; empty: words alone
    std::vector<std::string> words{};  // after "netem"
    bool shown = false;                // out of `tc qdisc show`, which names no distribution

    bool incoming() const;  // of an ifb device, which stands for what a machine receives
};

struct TcText {
    std::vector<TcQdisc> qdiscs;     // one for each device, in the order of the text
    std::vector<std::string> notes;  // what was left out, a sentence each
};

// Throws Error (usage) if no netem qdisc is left at the end, or if one device has several for different packets.
TcText read_tc_text(std::string_view text);

// True if the text names tc or begins like the output of `tc qdisc show`.
bool looks_like_tc_commands(std::string_view text);

}  // namespace thimble
