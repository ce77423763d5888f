// One check for each kind of input from outside. The fuzzer fuzz_NAME calls check_NAME, and so do the hostile tests of every build.
// A flaw is a broken promise: input that is neither refused as what it is, nor good.
#pragma once

#include <string>
#include <string_view>

#include "common/channel.hpp"

namespace thimble {

struct Verdict {
    bool accepted = false;
    std::string flaw{};  // empty if all is as it was promised
};

inline std::string_view text_of(Bytes bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
inline Bytes bytes_of_text(std::string_view text) {
    return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

// A datagram of cannelloni, and frames (13 bytes each: identifier, length, data) for the master of twelve drives and for a drive. The same
// bytes as words of TouchDIVERs' middleware.
Verdict check_can(Bytes bytes);
// A configuration file, read with every reader of ConfigTable.
Verdict check_config(Bytes text);
// A datagram for decode(). A message that gets in is plausible and comes back the same.
Verdict check_decode(Bytes datagram);
// Bytes of a Falcon. The first byte says where the rest is cut in two; the cut must not matter.
Verdict check_falcon(Bytes bytes);
// A script of moves at both ends of a handshake: bytes made up, genuine datagrams changed, repeated or turned back, and genuine
// progress in between. An end accepts only messages that the other end sent, and each once.
Verdict check_handshake(Bytes script);
// The first byte says how long the descriptor of a HID device is; what follows it are reports of the same length, of a hand and of a
// fingertip board.
Verdict check_hid(Bytes bytes);
// A datagram for the far side of a link test. The first byte chooses what is made right, so that the deeper checks are reached.
Verdict check_link_test(Bytes bytes);
// An MCAP file. Its whole records go into a new file, which must be whole and hold the same messages.
Verdict check_log(Bytes bytes);
// A needle file: refused with file and line, or samples as session/records/needle_file.hpp promises them, along which a scene can be
// stepped.
Verdict check_needle(Bytes text);
// A description of a network. The first byte chooses the reader: '0' tc's words, '1' .dist, '2' trace (CSV), '3' mahimahi, '4' pcap,
// '5' irtt, '6' ping, '7' profile, '8' an IP packet or a frame with one.
inline constexpr unsigned kNetworkReaders = 9;
Verdict check_network_files(Bytes bytes);
// A table of trials, a trajectory, or the events beside it; accepted by one of the three readers. Rows are the same when they are
// written and read again.
Verdict check_recorded(Bytes text);
// A scene that every solver builds, or refuses with a step that it takes, and that stays finite wherever the needle goes.
Verdict check_scene(Bytes text);
// A datagram for the end of a sealed flow, and the same bytes as words about keys, which only a peer can say.
Verdict check_sealed(Bytes datagram);
// A session file. Settings whose limits stand, or an Error about usage (or about the data of a file that the text names).
Verdict check_session(Bytes text);
// The first byte chooses: a script of moves at a sealed end of the stop bus, or a datagram at an open end. At the sealed end only a
// genuine stop stops, and only a genuine release releases. Accepted: it was stopped.
Verdict check_stop(Bytes bytes);

}  // namespace thimble
