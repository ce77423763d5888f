#include <vector>

#include "session/log/packet_fields.hpp"
#include "tests/fuzz/checks.hpp"
#include "thimble/log/log_tools.hpp"

namespace thimble {
namespace {

struct FuzzSink final : McapSink {
    std::vector<std::uint8_t> bytes;
    void write(Bytes more) override { bytes.insert(bytes.end(), more.begin(), more.end()); }
};

// Made once: it is most of what a look at a small file costs.
const PacketFields& all_fields() {
    static const PacketFields kFields;
    return kFields;
}

// Looks at every message as an export does.
struct FuzzReader final : McapVisitor {
    const PacketFields& fields = all_fields();
    std::vector<std::uint64_t> aligned;
    std::uint64_t bytes = 0;
    void message(const McapMessage& m) override {
        bytes += m.data.size();
        Bytes packet;
        if (!verify_packet(m.data, aligned, packet)) return;
        if (const PacketPart* kind = fields.kind_of(packet)) fields.values(packet, *kind);
    }
};

const char* flaw_of_log(Bytes bytes) {
    FuzzReader old, repaired;
    const McapScan scan = scan_mcap(bytes, old);
    if (scan.whole_bytes > bytes.size()) return "more whole bytes than bytes";
    if (!scan.begins && scan.messages > 0) return "messages of what is no log";
    FuzzSink sink;
    McapWriter writer(sink, "fuzz");
    copy_whole_records(bytes, writer);
    writer.finish();
    const McapScan again = scan_mcap(sink.bytes, repaired);
    if (!again.finished) return "the repaired log is not whole";
    if (!again.flaws.empty()) return "the repaired log has flaws";
    if (again.messages != scan.messages || old.bytes != repaired.bytes)
        return "the repaired log has other messages";
    return "";
}

}  // namespace

Verdict check_log(Bytes bytes) { return {false, flaw_of_log(bytes)}; }

}  // namespace thimble
