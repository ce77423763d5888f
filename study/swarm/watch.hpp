// Watches a virtual session at every instant, and its devices and wires at every call, for what breaks an invariant.
#pragma once

#include <array>
#include <deque>
#include <initializer_list>

#include "common/control/port_observer.hpp"
#include "session/virtual/virtual_session.hpp"
#include "study/swarm/invariants.hpp"

namespace thimble {

// When an input that is new came last. A datagram that waited while its program stood still came when the program went on.
struct InputNews {
    SessionTime at{};
    std::uint64_t instance = 0;
    std::uint32_t sequence = 0;

    void hear(SessionTime now, const Header& header) {
        if (header.instance == instance && sequence_ahead(header.sequence, sequence) <= 0) return;
        at = now;
        instance = header.instance;
        sequence = header.sequence;
    }
};

class Watch {
  public:
    // `unreadable`: what a datagram says cannot be believed here (sealed, or with bits that flip), and each that comes counts as news.
    Watch(const SystemSettings& settings, bool unreadable);
    void look_at(VirtualSession& session) { session_ = &session; }

    void begin_trial(const TrialConditions& conditions);
    // The network may take so long from now on, there and back.
    void allow_delay(Duration both_ways) { allowed_ = std::max(allowed_, both_ways); }
    void freeze(Role role);
    void run_again(Role role, bool anew);
    void release();
    // Some datagrams of this port do not arrive.
    void disturb(Port port);
    void fail(Rule rule, std::string text);

    // Of the handle: a force is commanded, a trial begins or ends, a sample is read.
    void handle_commanded(SessionTime now, double force_N);
    void handle_enabled();
    void handle_read(SessionTime now, const HandleSample& sample);
    void finger_commanded(SessionTime now, double force_N);
    void finger_felt(double force_N);
    void bar_drawn(SessionTime now, const Scene& scene);
    void sample_recorded(const TrajectorySample& sample);
    // At the sender's end of a wire, and where it is not lost at the other one.
    void sent(Port to, Bytes datagram);
    void arrived(Port to, Bytes datagram);

    void instant();
    // The trial is over for so long that all outputs rest.
    void rests();
    void count();

    const std::optional<Violation>& violation() const { return verdict_.first(); }
    // Of all commands to handle and finger, all scenes and all recorded samples.
    std::uint64_t digest() const { return digest_; }

  private:
    struct Program {
        bool frozen = false;
        bool stopped = false;
        bool new_instance = false;  // since the stop began
        SessionTime since{};        // it runs without a break
    };
    struct Force {
        SessionTime at{};
        double force_N = 0;
    };
    SessionTime now() const { return session_ == nullptr ? SessionTime{} : session_->now(); }
    Program& of(Role role) { return programs_.at(static_cast<std::size_t>(role)); }
    const StopBus& bus(Role role) const;
    Duration silence(const InputNews& input, Role role);
    Duration most_silence(const StalePolicy& policy) const;
    void mix(std::initializer_list<double> numbers);
    void hear_force(const Message& message);
    void hear_needle(const ForceFeedback& feedback, std::uint32_t trial);
    void forget_needle();
    void watch_begin();
    void watch_handle();
    bool covers(const Force& force) const;
    void watch_finger();
    void watch_needle();
    bool has_settled(Role role);
    bool look_for_stops();
    void forget_release();
    void watch_stops();
    void watch_rest(Role role);

    const SystemSettings& settings_;
    bool unreadable_;
    VirtualSession* session_ = nullptr;
    Verdict verdict_;
    std::array<Program, kRoleCount> programs_{};
    Modality modality_ = Modality::kHF;
    Duration allowed_{}, stood_still_{};
    SessionTime frozen_at_{};

    InputNews force_handle_, force_finger_, force_bar_, needle_;
    SessionTime newest_echo_{};
    double lowest_N_ = 0, highest_N_ = 0;          // of all that came to the handle
    std::deque<Force> forces_;                     // that came to the handle and may still act, newest last
    std::array<SessionTime, kRoleCount> began_{};  // when a node's trial began
    std::array<bool, kRoleCount> runs_{};
    double handle_N_ = 0, finger_N_ = 0, bar_N_ = 0;
    SessionTime commanded_at_{};
    double before_N_ = 0;  // at the handle before that instant
    Duration grown_{};     // the time in which its force may have grown
    std::uint64_t digest_ = 0xcbf29ce484222325U;

    PortObserver energy_;
    struct Energy {
        SessionTime at{};
        double energy_J = 0;
    };
    std::deque<Energy> highest_J_;  // of the window, falling
    bool gave_too_much_ = false;

    ForceFeedback newest_;                        // of slave_sim
    std::uint32_t trial_ = 0, newest_trial_ = 0;  // that runs, that slave_sim answered in
    double last_sample_s_ = -1;
    SessionTime stop_since_ = kNever, none_held_since_ = kNever;  // the latter since a release
    bool buses_disturbed_ = false, released_ = false;
};

}  // namespace thimble
