// One directed flow of messages, as its receiver and its sender see it.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <variant>

#include "common/channel.hpp"
#include "common/codec.hpp"
#include "common/messages.hpp"
#include "common/shared_message.hpp"

namespace thimble {

// Serial number arithmetic (RFC 1982): how far `a` is ahead of `b`, right across the wrap.
constexpr std::int32_t sequence_ahead(std::uint32_t a, std::uint32_t b) {
    return static_cast<std::int32_t>(a - b);
}

struct FlowCounters {
    std::uint64_t accepted = 0;
    std::array<std::uint64_t, static_cast<std::size_t>(Refusal::kCount)> refused{};

    std::uint64_t of(Refusal refusal) const { return refused[static_cast<std::size_t>(refusal)]; }
    std::uint64_t refused_total() const;
    void add(const FlowCounters& other);
};

// Decides what gets in: only messages of the expected sender, one instance of it, newest sequence first,
// stamps that increase. Everything else is counted by name and otherwise harmless.
class InboundFlow {
  public:
    explicit InboundFlow(Role expected_sender) : sender_(expected_sender) {}

    // The message if it is new and trustworthy, else null; valid until the next call.
    const Message* admit(SessionTime now, Bytes datagram);
    // The same of a message that was handed over.
    const Message* admit(SessionTime now, const Message& message);
    // The next admitted message waiting on the channel, null when the channel is empty or too much of it was refused in a row.
    const Message* receive(SessionTime now, Channel& channel) {
        return channel.known_empty() ? nullptr : take(now, channel);
    }

    // Empties the channel: each admitted message that holds a Wanted and belongs to the running trial goes to
    // `use`; the others are counted.
    template <class Wanted, class Use>
    void drain(SessionTime now, Channel& channel, bool running, std::uint32_t trial, Use&& use) {
        drain_all(now, channel, running, trial, [&](const Message& message) {
            const auto* body = std::get_if<Wanted>(&message.body);
            if (body != nullptr) use(message.header, *body);
            return body != nullptr;
        });
    }
    // The same where several kinds arrive: `use` says whether the message makes sense there.
    template <class Use>
    void drain_all(SessionTime now, Channel& channel, bool running, std::uint32_t trial, Use&& use) {
        filter_ = true;
        running_ = running;
        trial_ = trial;
        while (const Message* message = receive(now, channel)) {
            if (!use(*message)) refuse_admitted(Refusal::kUnexpectedKind);
        }
    }

    // Counts a message that was admitted here but makes no sense where it arrived.
    void refuse_admitted(Refusal refusal);

    // When the newest message was admitted; SessionTime{} before the first.
    SessionTime last_accepted() const { return last_accepted_; }
    bool silent_for(SessionTime now, Duration limit) const { return now - silent_since_ > limit; }
    // This program stood still for so long and read no message. That part of the silence says nothing about the sender.
    void did_not_listen(Duration time) {
        silent_since_ += time;
        excused_until_ += time;
    }
    // The network has become slower. Silence until `when` says nothing about the sender.
    void excuse_silence_until(SessionTime when) { excused_until_ = when; }
    bool lost_for(SessionTime now, Duration limit) const {
        return silent_for(now, limit) && now - excused_until_ > limit;
    }
    // A trial begins: the silence clock starts anew, and the first sender of this trial is accepted.
    void expect_from(SessionTime now) {
        last_accepted_ = silent_since_ = now;
        excused_until_ = {};
        locked_ = false;
    }
    const FlowCounters& counters() const { return counters_; }

  private:
    const Message* take(SessionTime now, Channel& channel);
    Refusal judge(SessionTime now, const Header& header) const;  // kCount: none
    void remember(SessionTime now, const Header& header);

    Role sender_;
    bool filter_ = false;  // by trial, once drain() was called
    bool running_ = false;
    std::uint32_t trial_ = 0;
    bool locked_ = false;
    std::uint64_t instance_ = 0;
    std::uint32_t newest_ = 0;
    SessionTime stamp_{};
    SessionTime heard_{};
    SessionTime last_accepted_{};
    SessionTime silent_since_{};
    SessionTime excused_until_{};
    FlowCounters counters_;
    Message message_;  // of bytes
};

// Numbers, stamps and sends.
class OutboundFlow {
  public:
    // Whether receivers take a body; none: no flow has looked.
    using Verdict = std::optional<bool>;

    OutboundFlow(Role sender, std::uint64_t instance, std::initializer_list<Channel*> channels);

    template <class Body>
    void send(SessionTime now, std::uint32_t trial, const Body& body) {
        Verdict good;
        send(now, trial, body, good);
    }
    // The same body by several flows of one sender, at the same time: the first one looks.
    template <class Body>
    void send(SessionTime now, std::uint32_t trial, const Body& body, Verdict& good) {
        if (pool_ == nullptr) return transmit(next(now, trial), body);
        SharedMessage& shared = pool_->take();
        shared.message.header = next(now, trial);
        shared.message.body = body;
        if (!good) good = !refusal_of(shared.message);
        post(shared, *good);
    }
    std::uint32_t sequence() const { return sequence_; }

  private:
    // Of its parts: a copy of a header that has just been changed would wait for the changes, 3 % of the time of a study.
    Header next(SessionTime now, std::uint32_t trial) {
        return {instance_, now, ++sequence_, trial, sender_};
    }
    void transmit(const Header& header, const Body& body);
    void post(SharedMessage& shared, bool good);

    Role sender_;
    std::uint64_t instance_;
    std::uint32_t sequence_ = 0;  // of the newest message
    Encoder encoder_;
    std::array<Channel*, 8> channels_{};
    std::size_t channel_count_ = 0;
    MessagePool* pool_ = nullptr;  // of the channels that hand over
};

}  // namespace thimble
