#include "master/devices/haply/haply_handle.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"
#include "master/devices/mailbox_handle.hpp"

namespace thimble {
namespace {

constexpr Duration kConnectLimit = std::chrono::seconds{2}, kFarewell = std::chrono::milliseconds{100};

// The service's first message is its list.
std::string choose_device(HaplyLink& link, const std::string& wanted) {
    const auto list = link.receive(kConnectLimit);
    if (!list)
        throw Error(ExitCode::kUsage,
                    "the service at [handle.haply] port sends no list of devices{}: is it Haply's service?",
                    link.trouble().empty() ? "" : " (" + link.trouble() + ")");
    const auto ids = haply_device_ids(*list);
    const std::string there = fmt::format("{}", fmt::join(ids, ", "));
    if (ids.empty())
        throw Error(
            ExitCode::kUsage,
            "the Haply Inverse Service lists no Inverse3: plug it in and switch it on, and look for it "
            "in the Haply Hub");
    if (wanted.empty() && ids.size() == 1) return ids.front();
    if (wanted.empty())
        throw Error(ExitCode::kUsage,
                    "the Haply Inverse Service lists {}: name one in [handle.haply] device_id", there);
    if (std::find(ids.begin(), ids.end(), wanted) != ids.end()) return wanted;
    throw Error(ExitCode::kUsage, "[handle.haply] device_id: no Inverse3 '{}'; the service lists {}", wanted,
                there);
}

}  // namespace

HaplyExchange::HaplyExchange(const HaplySettings& settings)
    : force_key_(settings.force_key),
      link_(settings.port, kConnectLimit),
      device_id_(choose_device(link_, settings.device_id)) {}

HaplyExchange::~HaplyExchange() {
    ending_ = true;
    if (thread_.joinable()) {
        thread_.join();
        link_.receive(Duration::zero());  // a send that is under way may end
        send({});
    }
    link_.close(kFarewell);
}

void HaplyExchange::start(const RuntimeSettings& runtime) {
    thread_ = std::thread([this, runtime] { run(runtime); });
}

void HaplyExchange::run(const RuntimeSettings& runtime) try {
    block_signals();
    good_at_ = wall_now();
    ask_for_realtime(runtime);  // if it is refused the node's loop says so
    while (!ending_ && mailbox_.loss().empty()) {
        const SessionTime begin = wall_now();
        turn(begin);
        wall_sleep(std::max(begin + kPeriod - wall_now(), Duration::zero()));
    }
} catch (const std::exception& error) {
    mailbox_.lose(error.what());
}

void HaplyExchange::turn(SessionTime now) {
    const DeviceVector force_N = mailbox_.carry(now, !good_);
    // One message is on its way at a time, and one more when the service is late with the answer to a force.
    const bool sent = (unanswered_ == 0 || (!good_ && unanswered_ == 1 && pushed_)) && send(force_N);
    const auto message = newest();
    idle_turns_ = sent || message ? 0 : idle_turns_ + 1;
    if (idle_turns_ >= kIdleTurns) unanswered_ = 0;
    good_ = take(message);
    count(now);
    if (!mailbox_.loss().empty()) send({});
}

// Older messages say where the device was. A service that never stops is not read for ever.
std::optional<std::string> HaplyExchange::newest() {
    auto message = link_.receive(kAnswerLimit);
    for (int more = 0; message && more < kMostMessages; ++more) {
        if (unanswered_ > 0) --unanswered_;
        auto next = link_.receive(Duration::zero());
        if (!next) break;
        message = std::move(next);
    }
    return message;
}

void HaplyExchange::count(SessionTime now) {
    bad_turns_ = good_ ? 0 : bad_turns_ + 1;
    if (good_) {
        good_at_ = now;
        trouble_.clear();
    }
    if (!link_.trouble().empty()) mailbox_.lose(link_.trouble());
    if (bad_turns_ >= kFewestBadTurns && now - good_at_ > kLostAfter)
        mailbox_.lose(trouble_.empty() ? "the service does not answer: is it running?" : trouble_);
}

bool HaplyExchange::send(const DeviceVector& force_N) {
    if (!link_.send(haply_command(device_id_, force_key_, force_N))) return false;
    ++unanswered_;
    pushed_ = force_N != DeviceVector{};
    return true;
}

bool HaplyExchange::take(const std::optional<std::string>& message) {
    if (!message) return false;
    HaplyReading reading = read_haply_state(*message, device_id_);
    if (!reading.state) {
        trouble_ = std::move(reading.trouble);
        return false;
    }
    calibrated_ = reading.state->calibrated;
    mailbox_.publish(reading.state->position_m, 0);
    return true;
}

namespace {

// The handle goes first, then the exchange with its last message.
class HaplyHandle final : private HaplyExchange, public MailboxHandle {
  public:
    HaplyHandle(const HaplySettings& settings, double force_limit_N, const RuntimeSettings& runtime)
        : HaplyExchange(settings),
          MailboxHandle(settings.axis, force_limit_N, 0, HaplyExchange::name(), mailbox()) {
        start(runtime);
    }

    std::string name() const override { return MailboxHandle::name(); }

  private:
    std::string next_step() override {
        return calibrated() ? "" : "not calibrated: follow the Haply Hub until its light is white";
    }
};

}  // namespace

std::unique_ptr<Handle> open_haply(const HaplySettings& settings, double force_limit_N,
                                   const RuntimeSettings& runtime) {
    return std::make_unique<HaplyHandle>(settings, force_limit_N, runtime);
}

}  // namespace thimble
