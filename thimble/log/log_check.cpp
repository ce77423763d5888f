#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/codec.hpp"
#include "common/error.hpp"
#include "common/flow.hpp"
#include "session/log/packet_fields.hpp"
#include "thimble/log/log_tools.hpp"

namespace thimble {
namespace {

// Of messages that passed: the sender's instance tells one start of a program from the next.
class HeaderReader {
  public:
    // Null if the bytes are no packet.
    const Header* read(Bytes bytes) {
        Bytes packet;
        if (!verify_packet(bytes, aligned_, packet)) return nullptr;
        static_cast<void>(decode_into(packet, message_));
        return &message_.header;
    }

  private:
    std::vector<std::uint64_t> aligned_;
    Message message_;
};

// One sender's messages on one topic in one file.
struct Course {
    std::optional<std::uint32_t> newest;
    SessionTime stamp{};
};

using FlowOfFile = std::pair<std::string, std::uint64_t>;  // topic, instance

class FileCheck {
  public:
    explicit FileCheck(const LoggedFile& file) : file_(file) {}

    FileFinding check() {
        file_.for_each(
            [this](const LoggedTopic& topic, const McapMessage& message) { look(topic, message); });
        say_problems();
        return std::move(finding_);
    }

  private:
    void look(const LoggedTopic& topic, const McapMessage& message) {
        if (message.log_time_ns < last_ns_) ++finding_.backward;
        last_ns_ = std::max(last_ns_, message.log_time_ns);
        if (!topic.readable) return;
        const Header* header = headers_.read(message.data);
        if (header == nullptr) {
            ++finding_.unreadable;
            return;
        }
        Course& course = courses_[{topic.topic, header->instance}];
        const std::int32_t ahead = course.newest ? sequence_ahead(header->sequence, *course.newest) : 1;
        if (ahead <= 0) return;  // an old one: the flows' business
        if (header->send_time < course.stamp) ++finding_.stamps_backward;
        if (topic.sent && course.newest) finding_.missing_sent += static_cast<std::uint64_t>(ahead - 1);
        course.newest = header->sequence;
        course.stamp = header->send_time;
    }

    void say(bool wrong, std::string words) {
        if (wrong) finding_.problems.push_back(std::move(words));
    }

    void say_problems() {
        const McapScan& scan = file_.scan();
        for (const std::string& flaw : scan.flaws) say(true, flaw);
        say(!scan.finished, describe_end(file_));
        say(finding_.unreadable > 0,
            fmt::format("{} messages are no thimble.wire.Packet", finding_.unreadable));
        say(finding_.backward > 0, fmt::format("log times go back {} times", finding_.backward));
        say(finding_.stamps_backward > 0,
            fmt::format("senders' stamps go back {} times", finding_.stamps_backward));
        say(file_.lost() > 0,
            fmt::format("the log itself lost {} messages: no room in its queue, or on the disk",
                        file_.lost()));
        say(finding_.missing_sent > file_.lost(),
            fmt::format("{} messages were sent and are not in the log, which knows of {}",
                        finding_.missing_sent, file_.lost()));
    }

    const LoggedFile& file_;
    HeaderReader headers_;
    FileFinding finding_;
    std::map<FlowOfFile, Course> courses_;
    std::uint64_t last_ns_ = 0;
};

struct BothEnds {
    std::vector<std::uint32_t> sent, received;  // received: in the order of arrival
    bool has_sender = false, has_receiver = false;
};

void compare(BothEnds& ends, FlowFinding& sum) {
    std::sort(ends.sent.begin(), ends.sent.end());
    const std::uint32_t first = ends.sent.front(), last = ends.sent.back();
    const auto outside = [&](std::uint32_t sequence) { return sequence < first || sequence > last; };
    ends.received.erase(std::remove_if(ends.received.begin(), ends.received.end(), outside),
                        ends.received.end());
    std::uint32_t newest = 0;
    for (const std::uint32_t sequence : ends.received) {
        if (sequence < newest) ++sum.out_of_order;
        newest = std::max(newest, sequence);
    }
    std::sort(ends.received.begin(), ends.received.end());
    const auto repeated = std::unique(ends.received.begin(), ends.received.end());
    sum.repeated += static_cast<std::uint64_t>(ends.received.end() - repeated);
    ends.received.erase(repeated, ends.received.end());
    for (const std::uint32_t sequence : ends.received) {
        const bool known = std::binary_search(ends.sent.begin(), ends.sent.end(), sequence);
        ++(known ? sum.received : sum.foreign);
    }
    sum.sent += ends.sent.size();
    sum.lost = sum.sent - sum.received;
}

// In the order of the report's links.
constexpr std::array<std::string_view, 4> kRelayedTopics{
    "/master/needle_command", "/slave_sim/force_feedback/master", "/slave_sim/force_feedback/cutaneous",
    "/slave_sim/force_feedback/visual"};
constexpr std::array kFatesOfPackets{"lost", "outage", "queue_full", "overflowed", "oversized"};

RelayFinding compare_with_relay(const FlowFinding& flow, const nlohmann::json& link) {
    const auto count = [&](const char* name) { return link.at(name).get<std::int64_t>(); };
    RelayFinding finding;
    finding.topic = flow.topic;
    finding.lost = flow.lost;
    for (const char* fate : kFatesOfPackets) {
        const std::int64_t packets = count(fate);
        finding.named += static_cast<std::uint64_t>(packets);
        if (packets > 0)
            finding.names += fmt::format("{}{} {}", finding.names.empty() ? "" : ", ", packets, fate);
    }
    const std::int64_t pushed = count("pushed"), delivered = count("delivered");
    finding.before = static_cast<std::int64_t>(flow.sent) - pushed;
    finding.within = pushed + count("duplicated") - delivered - static_cast<std::int64_t>(finding.named);
    finding.behind = delivered - static_cast<std::int64_t>(flow.received + flow.repeated);
    const std::int64_t unreadable = count("corrupted");  // delivered, and refused where it came
    const auto wrong = [&](std::int64_t packets, std::int64_t more, const char* where) {
        if (packets >= 0 && packets <= kMostUnderWay + more) return;
        finding.problem +=
            fmt::format("{}{} packets {}", finding.problem.empty() ? "" : "; ", packets, where);
    };
    wrong(finding.before, 0, "were lost before the relay, which did not see them");
    wrong(finding.within, 0, "are neither delivered nor lost under a name by the relay");
    wrong(finding.behind, unreadable, "were lost behind the relay, which delivered them");
    return finding;
}

}  // namespace

FileFinding check_file(const LoggedFile& file) { return FileCheck(file).check(); }

// Several instances of a sender (a program started anew) are one line. Sequences that wrap, after 49 days, are not followed.
std::vector<FlowFinding> check_flows(const std::vector<std::unique_ptr<LoggedFile>>& files) {
    std::map<FlowOfFile, BothEnds> flows;
    HeaderReader headers;
    for (const auto& file : files) {
        file->for_each([&](const LoggedTopic& topic, const McapMessage& message) {
            const Header* header = topic.readable ? headers.read(message.data) : nullptr;
            if (header == nullptr) return;
            BothEnds& ends = flows[{topic.topic, header->instance}];
            (topic.sent ? ends.has_sender : ends.has_receiver) = true;
            (topic.sent ? ends.sent : ends.received).push_back(header->sequence);
        });
    }
    std::map<std::string, FlowFinding> by_topic;
    for (auto& [key, ends] : flows) {
        if (!ends.has_sender || !ends.has_receiver) continue;
        FlowFinding& sum = by_topic[key.first];
        sum.topic = key.first;
        compare(ends, sum);
    }
    std::vector<FlowFinding> findings;
    findings.reserve(by_topic.size());
    for (auto& [topic, finding] : by_topic) findings.push_back(finding);
    return findings;
}

std::vector<RelayFinding> check_relay(const std::vector<FlowFinding>& flows,
                                      const std::filesystem::path& report) {
    std::vector<RelayFinding> findings;
    findings.reserve(kRelayedTopics.size());
    try {
        std::ifstream file(report);
        const nlohmann::json links = nlohmann::json::parse(file).at("links");
        for (std::size_t i = 0; i < kRelayedTopics.size(); ++i) {
            const auto flow = std::find_if(flows.begin(), flows.end(), [&](const FlowFinding& one) {
                return one.topic == kRelayedTopics[i];
            });
            if (flow != flows.end()) findings.push_back(compare_with_relay(*flow, links.at(i)));
        }
    } catch (const nlohmann::json::exception& error) {
        throw Error(
            ExitCode::kData,
            fmt::format("{}: is no report of thimble-netem in a session: {}; check the logs without it",
                        report.string(), error.what()));
    }
    return findings;
}

}  // namespace thimble
