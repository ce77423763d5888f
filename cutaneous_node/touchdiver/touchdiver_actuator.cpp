#include "cutaneous_node/touchdiver/touchdiver_actuator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace thimble {
namespace {

constexpr Duration kStall = std::chrono::milliseconds{20};  // between ticks: no silence of the middleware's
constexpr std::size_t kLongestText = 80;                    // of a phase or a problem that it names
constexpr int kFull = 1000;
constexpr int kReads = 8;  // in a tick

// Text of the middleware may not break a line of ours.
std::string printable(std::string_view text) {
    std::string shown(text.substr(0, kLongestText));
    std::replace_if(
        shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    return shown;
}

}  // namespace

// Of those thimbles that this session uses.
template <class Use>
void TouchDiverActuator::for_each_thimble(Use&& use) const {
    for (const GloveSide side : {GloveSide::kLeft, GloveSide::kRight}) {
        if (side != settings_.acting && side != settings_.other) continue;
        for (const Thimble thimble : {Thimble::kThumb, Thimble::kIndex, Thimble::kMiddle})
            if (thimble == settings_.push || thimble == settings_.pull) use(side, thimble);
    }
}

TouchDiverActuator::TouchDiverActuator(const TouchDiverSettings& settings, double force_limit_N,
                                       ByteStream& stream)
    : settings_(settings), limit_N_(force_limit_N), stream_(stream) {
    unsent_.reserve(4096);
    phase_.reserve(kLongestText);
    problem_.reserve(kLongestText);
    tried_ = SessionTime{} - kTryAgain;
    trouble_ = Trouble::kAbsent;
    text_ = describe(trouble_);
}

void TouchDiverActuator::command(SessionTime now, Finger finger, double force_N) {
    // Written so that a NaN is no force.
    const bool pressed = finger != Finger::kNone && force_N > 0;
    target_ = {pressed ? finger : Finger::kNone, pressed ? std::min(force_N, limit_N_) : 0, now};
}

void TouchDiverActuator::release(SessionTime now) {
    target_ = felt_ = {Finger::kNone, 0, now};
    press(now);
    flush();
}

void TouchDiverActuator::use_hand(SessionTime now, Hand hand) {
    if (hand == hand_) return;
    hand_ = hand;
    release(now);
}

FingertipForce TouchDiverActuator::output(SessionTime /*now*/) {
    if (trouble_ != Trouble::kNone) return {Finger::kNone, 0, felt_.commanded};
    return {felt_.finger, felt_.force_N, felt_.commanded};
}

void TouchDiverActuator::tick(SessionTime now) {
    if (now - turned_ > kStall) heard_ += now - turned_;
    turned_ = now;
    look_after(now);
    if (open_) read(now);
    judge(now);
    if (open_) {
        press(now);
        ask(now);
        flush();
        close_if_unread();
    }
}

void TouchDiverActuator::look_after(SessionTime now) {
    const auto state = stream_.state();
    const bool was_open = std::exchange(open_, state == ByteStream::State::kOpen);
    if (open_ && !was_open) greet(now);
    if (was_open && !open_) news_ = true;
    if (state == ByteStream::State::kConnecting && now - tried_ >= kConnect) stream_.close();
    if (state != ByteStream::State::kClosed || now - tried_ < kTryAgain) return;
    tried_ = now;
    news_ = true;
    stream_.connect();
}

void TouchDiverActuator::greet(SessionTime now) {
    heard_ = started_ = now;
    asked_ = pressed_ = now - kAsk;
    came_bytes_ = 0;
    known_ = ran_ = false;
    kind_ = MiddlewareKind::kUnknown;
    for_each_thimble([this](GloveSide side, Thimble thimble) { told(told_, side, thimble) = kNotToldYet; });
    unsent_ = kMiddlewareStart;
}

void TouchDiverActuator::read(SessionTime now) {
    for (int i = 0; i < kReads; ++i) {
        const std::size_t more = stream_.receive(std::span(came_).subspan(came_bytes_));
        if (more == 0) return;
        came_bytes_ += more;
        std::size_t from = 0;
        const std::string_view all(came_.data(), came_bytes_);
        for (auto end = all.find(kMiddlewareEnd); end != std::string_view::npos;
             from = end + 1, end = all.find(kMiddlewareEnd, from))
            take(now, all.substr(from, end - from));
        came_bytes_ -= from;
        std::copy_n(came_.begin() + static_cast<std::ptrdiff_t>(from), came_bytes_, came_.begin());
        if (came_bytes_ < came_.size()) continue;
        ++bad_messages_;  // longer than any that is meant for us
        came_bytes_ = 0;
    }
}

void TouchDiverActuator::take(SessionTime now, std::string_view message) {
    if (const auto status = read_middleware_status(message)) return take_status(now, *status);
    if (message.empty() || is_middleware_message(message)) return;
    ++bad_messages_;
}

void TouchDiverActuator::take_status(SessionTime now, const MiddlewareStatus& status) {
    heard_ = now;
    const auto phase = status.phase.substr(0, kLongestText);
    news_ = news_ || !known_ || phase != phase_ || status.code != code_;
    if (phase != phase_) phase_ = phase;
    if (status.problem.substr(0, kLongestText) != problem_) problem_ = status.problem.substr(0, kLongestText);
    known_ = true;
    kind_ = status.kind;
    code_ = status.code;
    actuations_ = status.actuations;
    present_ = {status.left, status.right};
    ran_ = ran_ || phase == "RUNNING";
    // A device that was connected late needs a start. A person who has stopped it in its window wants none.
    if (phase != "IDLE" || ran_ || now - started_ < kTryAgain) return;
    started_ = now;
    unsent_ += kMiddlewareStart;
}

void TouchDiverActuator::ask(SessionTime now) {
    if (!unsent_.empty() || now - asked_ < kAsk) return;
    asked_ = now;
    add_question(unsent_, kind_, to_nanoseconds(now) / 1'000'000);
}

TouchDiverActuator::Pressed TouchDiverActuator::wanted() const {
    Pressed pressed{};
    if (trouble_ != Trouble::kNone || target_.finger == Finger::kNone) return pressed;
    const Thimble thimble = target_.finger == Finger::kIndex ? settings_.push : settings_.pull;
    const double share = std::min(target_.force_N / settings_.full_scale_N, 1.0);
    told(pressed, side(), thimble) = static_cast<int>(std::lround(kFull * share));
    return pressed;
}

// Force 0 is sent at once. Other forces wait for their turn, so that they do not queue in the middleware.
void TouchDiverActuator::press(SessionTime now) {
    if (!open_ || !unsent_.empty()) return;
    Pressed wanted = this->wanted();
    const bool may_press = now - pressed_ >= kPress;
    for_each_thimble([&](GloveSide side, Thimble thimble) {
        const int share = told(wanted, side, thimble);
        int& before = told(told_, side, thimble);
        if (share == before || (share > 0 && !may_press)) return;
        add_force(unsent_, side, thimble, static_cast<double>(share) / kFull);
        before = share;
        ++forces_;
        if (share > 0) pressed_ = now;
    });
    if (told_ == wanted) felt_ = target_;
}

void TouchDiverActuator::flush() {
    if (unsent_.empty()) return;
    unsent_.erase(0, stream_.send(unsent_));
}

// Closes a connection that the middleware does not read: no force 0 can overtake its queue. A new connection begins
// with force 0.
void TouchDiverActuator::close_if_unread() {
    if (trouble_ != Trouble::kSilent || unsent_.empty()) return;
    unsent_.clear();
    stream_.close();
}

void TouchDiverActuator::stop() {
    if (!open_) return;
    target_ = felt_ = {};
    asked_ = kNever;
    ran_ = true;  // and is not started again
    for_each_thimble([this](GloveSide side, Thimble thimble) {
        add_force(unsent_, side, thimble, 0);
        told(told_, side, thimble) = 0;
        add_stop_force(unsent_, side, thimble);
    });
    unsent_ += kMiddlewareStop;
    flush();
}

TouchDiverActuator::Trouble TouchDiverActuator::trouble_at(SessionTime now) const {
    if (!open_) return Trouble::kAbsent;
    if (now - heard_ >= kSilence) return Trouble::kSilent;
    if (!known_) return Trouble::kUnknown;
    if (phase_ != "RUNNING") return Trouble::kNotRunning;
    if (!actuations_) return Trouble::kSwitchedOff;
    return present_[static_cast<std::size_t>(side())] ? Trouble::kNone : Trouble::kNoDevice;
}

void TouchDiverActuator::judge(SessionTime now) {
    const Trouble trouble = trouble_at(now);
    if (trouble == trouble_ && !news_) return;
    trouble_ = trouble;
    news_ = false;
    text_ = describe(trouble);
}

std::string TouchDiverActuator::describe(Trouble trouble) const {
    const std::string who =
        fmt::format("TouchDIVER, middleware at TCP {}:{}: ", settings_.host, settings_.port);
    switch (trouble) {
        case Trouble::kNone:
            break;
        case Trouble::kAbsent:
            return fmt::format(
                "{}no connection ({}); start WEART's middleware there, or set host and port in "
                "[cutaneous.touchdiver]",
                who, stream_.why());
        case Trouble::kSilent:
            return fmt::format(
                "{}no report of its state for {} ms ({} unreadable messages); look at its window, and "
                "restart it",
                who, kSilence / std::chrono::milliseconds{1}, bad_messages_);
        case Trouble::kUnknown:
            return who + "it has not reported its state yet; wait, or restart it";
        case Trouble::kNotRunning:
            return fmt::format(
                "{}it is {}, not RUNNING{}; connect the device in its window, then start thimble-cutaneous "
                "again",
                who, printable(phase_),
                code_ == 0 ? "" : fmt::format(" (code {}: {})", code_, printable(problem_)));
        case Trouble::kSwitchedOff:
            return who + "its actuations are switched off; switch them on in its window";
        case Trouble::kNoDevice:
            return fmt::format(
                "{}no device for the {} hand is connected; connect it there, or set acting_hand and "
                "other_hand in [cutaneous.touchdiver]",
                who, side() == GloveSide::kLeft ? "left" : "right");
    }
    return "";
}

}  // namespace thimble
