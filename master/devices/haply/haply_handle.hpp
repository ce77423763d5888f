// Haply's Inverse3 by the maker's service. A thread of its own exchanges messages with the service, whose answer the master's loop must not
// wait for (haply_message.hpp). A force goes out with each message, at most each 0.5 ms.
//
// - An answer that takes longer than 3 ms, or is no state of the device: one message without force goes out at once, also into silence. The
//   next force comes after the next good answer, when the loop asks for one again. An answer that is lost costs 10 turns, about 30 ms.
//
// - If several messages have come, the newest has the position.
//
// - No good answer for 0.2 s, in 3 turns at least, or an end of the connection: the device is lost. No second connection is made.
#pragma once

#include <atomic>
#include <memory>
#include <thread>

#include "common/runtime/runtime_settings.hpp"
#include "master/devices/device_mailbox.hpp"
#include "master/devices/handle.hpp"
#include "master/devices/haply/haply_link.hpp"
#include "master/devices/haply/haply_message.hpp"

namespace thimble {

class HaplyExchange : boost::noncopyable {
  public:
    static constexpr Duration kAnswerLimit = std::chrono::milliseconds{3};
    static constexpr Duration kPeriod = std::chrono::microseconds{500};
    static constexpr Duration kLostAfter = std::chrono::milliseconds{200};  // before RemoteHandle gives up
    // After so many turns without a message either way the exchange waits no longer for an answer.
    static constexpr int kIdleTurns = 10;
    static constexpr int kMostMessages = 100;  // of a turn
    static constexpr int kFewestBadTurns = 3;  // a machine that stood still is no service that does

    // Connects, and chooses the device from the service's list. Throws Error (usage).
    explicit HaplyExchange(const HaplySettings& settings);
    // After start() a last message without force goes out first.
    ~HaplyExchange();

    // From now on a thread exchanges, scheduled as `runtime` says.
    void start(const RuntimeSettings& runtime);
    DeviceMailbox& mailbox() { return mailbox_; }
    std::string name() const { return "Haply Inverse3 " + device_id_; }
    bool calibrated() const { return calibrated_; }

  private:
    void run(const RuntimeSettings& runtime);
    void turn(SessionTime now);
    bool send(const DeviceVector& force_N);
    std::optional<std::string> newest();
    bool take(const std::optional<std::string>& message);
    void count(SessionTime now);

    HaplyForceKey force_key_;
    HaplyLink link_;
    std::string device_id_;
    DeviceMailbox mailbox_;
    int unanswered_ = 0, bad_turns_ = 0, idle_turns_ = 0;
    bool good_ = false;      // the last turn had a good answer
    bool pushed_ = false;    // the last message had a force
    SessionTime good_at_{};  // the last of them
    std::string trouble_;    // of the last message since then that is no state
    std::atomic<bool> calibrated_{true}, ending_{false};
    std::thread thread_;
};

std::unique_ptr<Handle> open_haply(const HaplySettings& settings, double force_limit_N,
                                   const RuntimeSettings& runtime);

}  // namespace thimble
