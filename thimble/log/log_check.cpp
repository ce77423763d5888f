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
#include "session/log/merged_log.hpp"
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
            fmt::format("{} messages are not thimble.wire.Packet", finding_.unreadable));
        say(finding_.backward > 0, fmt::format("log times go back {} times", finding_.backward));
        say(finding_.stamps_backward > 0,
            fmt::format("senders' stamps go back {} times", finding_.stamps_backward));
        say(file_.lost() > 0,
            fmt::format("{} messages are missing in the log: its queue or the disk was full", file_.lost()));
        say(finding_.missing_sent > file_.lost(),
            fmt::format("{} messages were sent but are not in the log; it knows about {} of them",
                        finding_.missing_sent, file_.lost()));
    }

    const LoggedFile& file_;
    HeaderReader headers_;
    FileFinding finding_;
    std::map<FlowOfFile, Course> courses_;
    std::uint64_t last_ns_ = 0;
};

// Message of one end, on the session's clock.
struct PassedMessage {
    std::uint32_t sequence = 0;
    std::int64_t at_ns = 0;
    bool operator<(const PassedMessage& other) const { return sequence < other.sequence; }
};

// A log that a flow arrives in: when its program took messages in, of any flow, and which of this one.
struct Receiver {
    std::int64_t first_ns = 0, last_ns = 0;
    std::uint32_t lowest = UINT32_MAX, highest = 0;
};

struct BothEnds {
    std::vector<PassedMessage> sent, received;  // received: in the order of arrival
    std::map<const LoggedFile*, Receiver> receivers;
};

// How long messages of a flow were under way.
struct UnderWay {
    std::int64_t shortest_ns = INT64_MAX, longest_ns = INT64_MIN;
    void add(std::int64_t ns) {
        shortest_ns = std::min(shortest_ns, ns);
        longest_ns = std::max(longest_ns, ns);
    }
};

// The receiver was not there to take the message in, or the message was still under way when its receiver ended. Between two messages that
// arrived a missing one is lost.
bool missed(const PassedMessage& message, const Receiver& receiver, const UnderWay& way, bool one_clock) {
    const bool early = !one_clock || message.at_ns + way.shortest_ns < receiver.first_ns;
    const bool late = !one_clock || message.at_ns + way.longest_ns > receiver.last_ns;
    return (message.sequence < receiver.lowest && early) || (message.sequence > receiver.highest && late);
}

void count_arrivals(BothEnds& ends, FlowFinding& sum) {
    const std::uint32_t first = ends.sent.front().sequence, last = ends.sent.back().sequence;
    std::erase_if(ends.received, [&](const auto& m) { return m.sequence < first || m.sequence > last; });
    std::uint32_t newest = 0;
    for (const PassedMessage& message : ends.received) {
        if (message.sequence < newest) ++sum.out_of_order;
        newest = std::max(newest, message.sequence);
    }
    std::stable_sort(ends.received.begin(), ends.received.end());
    const auto repeated = std::unique(ends.received.begin(), ends.received.end(),
                                      [](const auto& a, const auto& b) { return a.sequence == b.sequence; });
    sum.repeated += static_cast<std::uint64_t>(ends.received.end() - repeated);
    ends.received.erase(repeated, ends.received.end());
}

void compare(BothEnds& ends, FlowFinding& sum, bool one_clock) {
    std::stable_sort(ends.sent.begin(), ends.sent.end());
    count_arrivals(ends, sum);
    UnderWay way;
    std::vector<PassedMessage> missing;
    auto arrived = ends.received.begin();
    for (const PassedMessage& message : ends.sent) {
        while (arrived != ends.received.end() && *arrived < message) ++arrived;
        if (arrived == ends.received.end() || message < *arrived) {
            missing.push_back(message);
        } else {
            way.add(arrived->at_ns - message.at_ns);
        }
    }
    if (way.shortest_ns > way.longest_ns) way = {0, 0};  // nothing arrived that was sent
    for (const PassedMessage& message : ends.received)
        if (!std::binary_search(ends.sent.begin(), ends.sent.end(), message)) ++sum.foreign;
    const auto nobody_there = [&](const PassedMessage& message) {
        return std::all_of(ends.receivers.begin(), ends.receivers.end(), [&](const auto& receiver) {
            return missed(message, receiver.second, way, one_clock);
        });
    };
    const auto outside = std::count_if(missing.begin(), missing.end(), nobody_there);
    sum.sent += ends.sent.size();
    sum.received += ends.sent.size() - missing.size();
    sum.outside += static_cast<std::uint64_t>(outside);
    sum.lost = sum.sent - sum.received - sum.outside;
}

using Flows = std::map<FlowOfFile, BothEnds>;

// Adds one file's messages to the flows.
void take(const LoggedFile& file, const ClockOffsets& offsets, HeaderReader& headers, Flows& flows) {
    std::vector<Receiver*> own;
    std::int64_t first_ns = INT64_MAX, last_ns = INT64_MIN;
    file.for_each([&](const LoggedTopic& topic, const McapMessage& message) {
        const Header* header = topic.readable ? headers.read(message.data) : nullptr;
        if (header == nullptr) return;
        const auto at_ns = static_cast<std::int64_t>(message.log_time_ns) - offsets.at(message.log_time_ns);
        BothEnds& ends = flows[{topic.topic, header->instance}];
        if (topic.sent) {
            ends.sent.push_back({header->sequence, at_ns});
            return;
        }
        ends.received.push_back({header->sequence, at_ns});
        first_ns = std::min(first_ns, at_ns);
        last_ns = std::max(last_ns, at_ns);
        const auto [receiver, is_new] = ends.receivers.try_emplace(&file);
        if (is_new) own.push_back(&receiver->second);
        receiver->second.lowest = std::min(receiver->second.lowest, header->sequence);
        receiver->second.highest = std::max(receiver->second.highest, header->sequence);
    });
    for (Receiver* receiver : own) {
        receiver->first_ns = first_ns;
        receiver->last_ns = last_ns;
    }
}

// Whether times of several files can be compared: one boot of one machine, or offsets that the session measured.
bool have_one_clock(const std::vector<std::unique_ptr<LoggedFile>>& files) {
    const auto boot_of = [](const LoggedFile& file) { return file.value("thimble", "machine_boot"); };
    return std::all_of(files.begin(), files.end(), [&](const auto& file) {
        const bool same_boot = boot_of(*file) == boot_of(*files.front()) && !boot_of(*file).empty();
        return same_boot || (session_of(files) != nullptr && ClockOffsets(files, *file).known());
    });
}

void add_flows(Flows& flows, bool one_clock, std::map<std::string, FlowFinding>& by_topic) {
    for (auto& [key, ends] : flows) {
        if (ends.sent.empty() || ends.receivers.empty()) continue;
        FlowFinding& sum = by_topic[key.first];
        sum.topic = key.first;
        compare(ends, sum, one_clock);
    }
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
    wrong(finding.before, 0, "were lost before the relay, which did not receive them");
    wrong(finding.within, 0, "are neither delivered nor counted as lost by the relay");
    wrong(finding.behind, unreadable, "were lost after the relay, which sent them");
    return finding;
}

}  // namespace

FileFinding check_file(const LoggedFile& file) { return FileCheck(file).check(); }

// Several instances of a sender (a program started anew) are one line. Sequences that wrap, after 49 days, are not followed.
std::vector<FlowFinding> check_flows(const std::vector<std::unique_ptr<LoggedFile>>& files) {
    std::map<std::string, Flows> trials;  // of lock-step; else one
    HeaderReader headers;
    for (const auto& file : files)
        take(*file, ClockOffsets(files, *file), headers, trials[lock_step_trial(*file)]);
    const bool one_clock = have_one_clock(files);
    std::map<std::string, FlowFinding> by_topic;
    for (auto& [trial, flows] : trials) add_flows(flows, one_clock, by_topic);
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
            fmt::format("{}: is not a report of thimble-netem in a session: {}; run the check without it",
                        report.string(), error.what()));
    }
    return findings;
}

}  // namespace thimble
