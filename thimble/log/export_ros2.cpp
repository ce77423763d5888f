#include <array>
#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "common/codec.hpp"
#include "common/error.hpp"
#include "common/runtime/log/log_file.hpp"
#include "common/version.hpp"
#include "thimble/log/log_export.hpp"
#include "thimble/log/ros2_messages.hpp"

namespace thimble {
namespace {

constexpr std::string_view kJoint = "insertion";
constexpr std::size_t kRos2ChunkBytes = std::size_t{1} << 20;

// The output of one flow of the logs, by one of its topics.
struct Ros2Part {
    std::string_view from, told_by, words;
};
constexpr std::array<Ros2Part, 5> kRos2Parts{{
    {"/master/needle_command", "/master/measured_cp",
     "hand and commanded needle (/master/measured_*, /slave_sim/servo_*): logs of thimble-master, "
     "thimble-slave-sim"},
    {"/slave_sim/record", "/slave_sim/measured_cp",
     "needle, tissue and their forces (/slave_sim/...measured_*): logs of session, thimble-slave-sim"},
    {"/slave_sim/force_feedback/master", "/master/servo_cf",
     "the force that reached the master (/master/servo_cf): log of thimble-master"},
    {"/slave_sim/force_feedback/cutaneous", "/cutaneous/servo_cf",
     "the force that reached the fingertip device (/cutaneous/servo_cf): log of thimble-cutaneous"},
    {"/cutaneous/percept", "/cutaneous/measured_cf",
     "force on the finger (/cutaneous/measured_cf): logs of thimble-cutaneous, thimble-master"},
}};

// When something passed, in ns since 1970: on the session's clock where the logs say what the writer's differs from it by, else on
// the writer's own; since its machine's start, if the writer has not said when that was.
class DateClock {
  public:
    DateClock(const LoggedFile& of, const LoggedFile* session, bool known) {
        const LoggedFile& from = session != nullptr && known ? *session : of;
        on_session_ = &from != &of;
        const std::string realtime = from.value("thimble", "realtime_ns");
        const std::string monotonic = from.value("thimble", "monotonic_ns");
        ahead_ns_ =
            std::strtoull(realtime.c_str(), nullptr, 10) - std::strtoull(monotonic.c_str(), nullptr, 10);
    }
    std::int64_t date_ns(const MergedMessage& m) const {
        const auto own = on_session_ ? static_cast<std::uint64_t>(m.session_time_ns) : m.message.log_time_ns;
        const auto date = static_cast<std::int64_t>(own + ahead_ns_);
        return date < 0 ? 0 : date;
    }

  private:
    bool on_session_ = false;
    std::uint64_t ahead_ns_ = 0;  // of 1970's count, modulo 2^64
};

class Ros2Export {
  public:
    explicit Ros2Export(const std::filesystem::path& path)
        : file_(path), writer_(file_, std::string("thimble ") + kVersion, "ros2") {}

    void add(const Message& message, const LoggedFile* file, const LoggedTopic& topic, std::int64_t date_ns) {
        now_ns_ = date_ns;
        if (const auto* command = std::get_if<NeedleCommand>(&message.body)) add_command(*command);
        if (const auto* wave = std::get_if<NeedleWave>(&message.body)) add_command(wave->command);
        if (const auto* force = std::get_if<ForceFeedback>(&message.body)) add_force(*force, topic);
        if (const auto* wave = std::get_if<ForceWave>(&message.body)) add_force(wave->feedback, topic);
        if (const auto* percept = std::get_if<Percept>(&message.body)) add_percept(*percept, topic);
        if (const auto* control = std::get_if<SessionControl>(&message.body))
            add_event(file, topic, message.header, *control);
        if (writer_.chunk_bytes() > kRos2ChunkBytes) writer_.flush();
    }
    Ros2Written finish(const std::string& asked_for) {
        writer_.finish();
        Ros2Written written{channels_.size(), {}, false};
        for (const Ros2Part& part : kRos2Parts) {
            if (part.from.starts_with(asked_for) && !channels_.contains(std::string(part.told_by)))
                written.missing.emplace_back(part.words);
        }
        written.events_only = channels_.size() == channels_.count(ros2::kEvent.name);
        return written;
    }

  private:
    struct Line {
        std::uint16_t channel = 0;
        std::uint32_t sequence = 0;
    };

    void put(const Ros2Topic& topic, Ros2Value value) {
        value.stamp_ns = now_ns_;
        value.frame = topic.frame;
        Line& line = line_of(topic.name, topic.type);
        const auto time = static_cast<std::uint64_t>(now_ns_);
        writer_.add_message({line.channel, ++line.sequence, time, time, ros2_bytes(topic.type, value, cdr_)});
    }
    Line& line_of(const char* topic, Ros2Type type) {
        const auto found = channels_.find(topic);
        if (found != channels_.end()) return found->second;
        std::uint16_t& schema = schemas_.at(static_cast<std::size_t>(type));
        if (schema == 0) {
            const std::string text = ros2_definition(type);
            const std::vector<std::uint8_t> bytes(text.begin(), text.end());
            schema = writer_.add_schema(ros2_name(type), "ros2msg", bytes);
        }
        return channels_[topic] = {writer_.add_channel(schema, topic, "cdr", {{"offered_qos_profiles", ""}}),
                                   0};
    }

    void add_command(const NeedleCommand& c) {
        put(ros2::kHandPlace, {0, {}, c.position_hand_m});
        put(ros2::kHandVelocity, {0, {}, c.velocity_hand_m_per_s});
        // The only force that counts positive outwards.
        put(ros2::kHandForce, {0, {}, -c.force_hand_N});
        put(ros2::kHandJoint, {0, {}, c.position_hand_m, c.velocity_hand_m_per_s, -c.force_hand_N, kJoint});
        put(ros2::kNeedleRequest, {0, {}, c.position_needle_m});
        put(ros2::kNeedleVelocityRequest, {0, {}, c.velocity_needle_m_per_s});
    }

    // slave_sim's measures stand in the undelayed record, its requests in the messages that arrive.
    void add_force(const ForceFeedback& f, const LoggedTopic& topic) {
        if (topic.topic == "/slave_sim/force_feedback/master" && !topic.sent)
            put(ros2::kMasterRequest, {0, {}, f.force_total_N});
        if (topic.topic == "/slave_sim/force_feedback/cutaneous" && !topic.sent)
            put(ros2::kFingerRequest, {0, {}, f.force_total_N});
        if (topic.topic != "/slave_sim/record") return;
        put(ros2::kNeedlePlace, {0, {}, f.position_needle_m});
        put(ros2::kTotalForce, {0, {}, f.force_total_N});
        put(ros2::kTissueForce, {0, {}, f.force_tissue_N});
        put(ros2::kFixtureForce, {0, {}, f.force_fixture_N});
        put(ros2::kSurfacePlace, {0, {}, f.position_surface_m});
        put(ros2::kSurfaceVelocity, {0, {}, f.velocity_surface_m_per_s});
        put(ros2::kProxyPlace, {0, {}, f.position_proxy_m});
    }

    void add_percept(const Percept& p, const LoggedTopic& topic) {
        if (topic.topic == "/cutaneous/percept") put(ros2::kFingerForce, {0, {}, p.force_N});
    }

    // True for a new event: the session repeats an order to each node until it answers, and a network until the
    // session ends.
    bool is_news(const LoggedFile* file, const LoggedTopic& topic, const Header& header,
                 const SessionControl& control) {
        if (control.kind != ControlKind::kNetworkChange)
            return events_.insert({file, header.trial, control.kind}).second;
        // An overtaken order has an old network.
        const auto [last, first] =
            last_orders_.try_emplace({file, topic.topic, header.instance}, header.sequence);
        if (!first && static_cast<std::int32_t>(header.sequence - last->second) < 0) return false;
        last->second = header.sequence;
        const std::pair network(control.network_delay_s, std::string(control.network.view()));
        const auto [known, is_new] = networks_.try_emplace({file, header.trial}, network);
        return is_new || std::exchange(known->second, network) != network;
    }

    void add_event(const LoggedFile* file, const LoggedTopic& topic, const Header& header,
                   const SessionControl& control) {
        if (!is_news(file, topic, header, control)) return;
        const std::string text = ros2_event(control.kind, header.trial, control.modality, control.network,
                                            control.network_delay_s);
        Ros2Value value;
        value.text = text;
        put(ros2::kEvent, value);
    }

    LogFile file_;
    McapWriter writer_;
    CdrOutput cdr_;
    std::int64_t now_ns_ = 0;
    std::array<std::uint16_t, static_cast<std::size_t>(Ros2Type::kCount)> schemas_{};
    std::map<std::string, Line> channels_;
    std::set<std::tuple<const LoggedFile*, std::uint32_t, ControlKind>> events_;
    std::map<std::pair<const LoggedFile*, std::uint32_t>, std::pair<double, std::string>>
        networks_;  // by trial
    std::map<std::tuple<const LoggedFile*, std::string, std::uint64_t>, std::uint32_t> last_orders_;
};

// A message may stand in two logs. Arrivals are taken from the receiver's log, all else from the sender's, or without
// that from the other's.
class CopyChoice {
  public:
    explicit CopyChoice(const LoggedFiles& files) {
        for (const auto& file : files) {
            for (const auto& [id, topic] : file->topics()) {
                if (topic.sent) sent_.insert(topic.topic);
            }
        }
    }
    bool counts(const LoggedTopic& topic) const {
        const bool on_arrival = topic.topic.starts_with("/slave_sim/force_feedback/");
        return on_arrival ? !topic.sent : topic.sent || !sent_.contains(topic.topic);
    }

  private:
    std::set<std::string> sent_;
};

const LoggedFile* sessions_file(const LoggedFiles& files) {
    for (const auto& file : files) {
        if (file->value("thimble", "program") == "session") return file.get();
    }
    return nullptr;
}

}  // namespace

Ros2Written export_ros2(const LoggedFiles& files, const std::filesystem::path& path,
                        const std::string& topic) {
    const LoggedFile* const session = sessions_file(files);
    std::map<const LoggedFile*, DateClock> clocks;
    for (const auto& file : files)
        clocks.try_emplace(file.get(), *file, session, ClockOffsets(files, *file).known());
    const CopyChoice choice(files);
    const std::vector<MergedMessage> messages = merge_logs(files);  // or an Error, before there is a file
    Ros2Export to(path);
    std::vector<std::uint64_t> aligned;
    for (const MergedMessage& m : messages) {
        Bytes packet;
        if (!m.topic->topic.starts_with(topic) || !m.topic->readable || !choice.counts(*m.topic)) continue;
        if (!verify_packet(m.message.data, aligned, packet)) continue;
        const Decoded decoded = decode(packet);
        if (decoded.message) to.add(*decoded.message, m.file, *m.topic, clocks.at(m.file).date_ns(m));
    }
    return to.finish(topic);
}

}  // namespace thimble
