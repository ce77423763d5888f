// Where thimble-igtl has the state of a session from: a session that runs, or the logs of one that ran.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "common/runtime/sockets.hpp"
#include "visual_node/views/monitor_receiver.hpp"

namespace thimble {

class MonitorSource : boost::noncopyable {
  public:
    virtual ~MonitorSource() = default;

    virtual void update(SessionTime now) = 0;
    virtual const Monitor& newest() const = 0;
    virtual std::uint32_t trial() const = 0;
    virtual bool silent(SessionTime now) const = 0;
    virtual bool over() const { return false; }
    // Called when the first client has connected: playback begins now.
    virtual void start(SessionTime /*now*/) {}
};

// In the place of a view.
class LiveMonitor final : public MonitorSource {
  public:
    // `sockets` and their channel outlive this.
    LiveMonitor(Sockets& sockets, Channel& monitor) : sockets_(&sockets), receiver_(monitor) {}

    void update(SessionTime now) override;
    const Monitor& newest() const override { return receiver_.newest(); }
    std::uint32_t trial() const override { return receiver_.trial(); }
    bool silent(SessionTime now) const override { return receiver_.silent(now); }

  private:
    Sockets* sockets_;
    MonitorReceiver receiver_;
};

// The logs of one session with `[log] messages = "all"`, at `speed` times the pace of then.
class LoggedMonitor final : public MonitorSource {
  public:
    // Throws Error (data) if they cannot be read, or hold no positions and forces.
    LoggedMonitor(const std::vector<std::string>& logs, double speed);

    void update(SessionTime now) override;
    void start(SessionTime now) override { started_ = now; }
    const Monitor& newest() const override { return moments_[at_].monitor; }
    std::uint32_t trial() const override { return moments_[at_].trial; }
    bool silent(SessionTime) const override { return false; }
    bool over() const override { return at_ + 1 == moments_.size(); }

  private:
    struct Moment {
        std::int64_t time_ns = 0;
        std::uint32_t trial = 0;
        Monitor monitor{};
    };
    class Reading;
    std::vector<Moment> moments_;
    std::size_t at_ = 0;
    double speed_;
    SessionTime started_{};
};

}  // namespace thimble
