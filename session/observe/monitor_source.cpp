#include "session/observe/monitor_source.hpp"

#include "common/codec.hpp"
#include "common/error.hpp"
#include "session/log/merged_log.hpp"
#include "session/log/packet_fields.hpp"
#include "session/records/trial_record.hpp"

namespace thimble {

void LiveMonitor::update(SessionTime now) {
    sockets_->tick(now);
    receiver_.update(now, [](SessionTime, std::uint32_t, const Monitor&) {});
    sockets_->tick(now);
}

// The Monitor of that moment, made from the messages in the order of time.
class LoggedMonitor::Reading {
  public:
    explicit Reading(std::vector<Moment>& moments) : moments_(&moments) {}

    void add(std::int64_t time_ns, const std::string& topic, const Message& message) {
        const auto* control = std::get_if<SessionControl>(&message.body);
        const bool ended = control != nullptr && obey(message.header.trial, *control);
        if (ended && !moments_->empty()) moments_->push_back({time_ns, started_, now_});
        const auto* heartbeat = std::get_if<Heartbeat>(&message.body);
        if (heartbeat != nullptr && topic == "/master/heartbeats")
            now_.force_hand_N = heartbeat->force_hand_N;
        const auto* record = std::get_if<ForceFeedback>(&message.body);
        if (record == nullptr || topic != "/slave_sim/record") return;
        copy_state(*record, now_);
        now_.needle_held = record->needle_held;
        moments_->push_back({time_ns, message.header.trial, now_});
    }

  private:
    // True at the end of a trial, which no record need follow. The session repeats its orders.
    bool obey(std::uint32_t trial, const SessionControl& control) {
        const bool ends = control.kind == ControlKind::kTrialEnd;
        const bool stopped_at_once = ends && now_.state != NodeState::kRunning;
        if (control.kind == ControlKind::kBeep) now_.beeped = true;
        if ((control.kind == ControlKind::kTrialStart || stopped_at_once) && trial != started_)
            begin(trial, control);
        if (!ends || trial != started_ || now_.state != NodeState::kRunning) return false;
        now_.state = NodeState::kIdle;
        now_.reason = control.reason;
        return true;
    }
    void begin(std::uint32_t trial, const SessionControl& control) {
        started_ = trial;
        now_ = {};
        now_.state = NodeState::kRunning;
        now_.modality = control.modality;
        now_.position_fixture_m = control.fixture_position_m;
        now_.subject = control.subject;
    }
    std::vector<Moment>* moments_;
    Monitor now_;
    std::uint32_t started_ = 0;
};

LoggedMonitor::LoggedMonitor(const std::vector<std::string>& logs, double speed) : speed_(speed) {
    const std::vector<std::unique_ptr<LoggedFile>> files = open_logs(logs);
    Reading reading(moments_);
    std::vector<std::uint64_t> aligned;
    for (const MergedMessage& m : merge_logs(files)) {
        Bytes packet;
        if (!m.topic->readable || !verify_packet(m.message.data, aligned, packet)) continue;
        const Decoded decoded = decode(packet);
        if (decoded.message) reading.add(m.session_time_ns, m.topic->topic, *decoded.message);
    }
    if (!moments_.empty()) return;
    throw Error(ExitCode::kData,
                "{}: holds no topic /slave_sim/record, so there is nothing to show: give the session's log "
                "(session_<delay>ms.mcap) of a run with [log] messages = \"all\"",
                logs.front());
}

void LoggedMonitor::update(SessionTime now) {
    const auto passed_ns = static_cast<double>((now - started_).count()) * speed_;
    const double until_ns = static_cast<double>(moments_.front().time_ns) + passed_ns;
    while (!over() && static_cast<double>(moments_[at_ + 1].time_ns) <= until_ns) ++at_;
}

}  // namespace thimble
