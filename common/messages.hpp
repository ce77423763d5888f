// The messages between the nodes, as plain values. codec.hpp turns them into bytes and back; messages.fbs
// is the same list as a wire schema. SI units; one axis z, positive into the tissue; forces act on the
// operator.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

#include "common/time.hpp"

namespace thimble {

// kExperimenter is no node of a session: a view that comes and goes.
enum class Role : std::uint8_t { kSession, kMaster, kSlaveSim, kCutaneous, kVisual, kNetem, kExperimenter };
inline constexpr std::size_t kRoleCount = 7;
// HF: handle. CF: fingers of the acting hand. CCF: fingers of the other hand. VF: bar on the screen.
enum class Modality : std::uint8_t { kHF, kCF, kCCF, kVF };
inline constexpr std::array kModalities{Modality::kHF, Modality::kCF, Modality::kCCF, Modality::kVF};
enum class TissuePhase : std::uint8_t { kFree, kContact, kPenetrated };
enum class Finger : std::uint8_t { kNone, kIndex, kThumb };
enum class ControlKind : std::uint8_t {
    kTrialStart,
    kBeep,
    kFixtureChange,
    kTrialEnd,
    kShutdown,
    kNetworkChange,
};
enum class NodeState : std::uint8_t { kIdle, kRunning, kFinished, kFailed };
// kSafetyStop: the guard before a device tripped, or a node missed its deadlines. kEmergencyStop: a person pressed stop.
enum class EndReason : std::uint8_t {
    kNone,
    kCompleted,
    kTimeout,
    kPeerLost,
    kInterrupted,
    kDeviceFault,
    kSafetyStop,
    kEmergencyStop,
};
inline constexpr EndReason kLastEndReason = EndReason::kEmergencyStop;
// Everything stands still until a person releases it.
constexpr bool is_stop(EndReason reason) {
    return reason == EndReason::kSafetyStop || reason == EndReason::kEmergencyStop;
}
enum class StopKind : std::uint8_t { kStop, kRelease, kAsk };

// An order of a view to the session.
enum class OrderKind : std::uint8_t {
    kDelay,  // value: one-way delay, s, as [netem] force.delay_s
    kStart,  // a trial of this modality, ending the running one
    kPause,  // no further trial
    kResume,
    kEndTrial,
    kQuit,
    kRepeat,   // which trial
    kExclude,  // which trial
    kSeek,     // of a replay: value, s
    kSpeed,    // of a replay: value, 1 as recorded
    kNetwork,  // network: the profile whose both ways hold from now on
    kAnswer,   // of the subject's screen: trial, which question; value, the answer
};
// The text for the subject between trials.
enum class PageKind : std::uint8_t {
    kNone,
    kWelcome,
    kPractice,
    kReady,
    kBreak,
    kPaused,
    kDone,
    kWait,
    kQuestion
};
inline constexpr std::size_t kPageKinds = static_cast<std::size_t>(PageKind::kQuestion) + 1;
// The experimenter starts the next trial, or the subject if the protocol allows it.
constexpr bool waits_to_go_on(PageKind kind) {
    return kind == PageKind::kWelcome || kind == PageKind::kPractice || kind == PageKind::kReady;
}

// The name of a network profile (docs/network-profiles.md): lower case letters, digits and '-', padded with zeros.
// Empty: the session file's own network.
struct NetworkName {
    std::array<std::uint8_t, 16> text{};

    // Nothing for a text that is too long or has other characters.
    static std::optional<NetworkName> of(std::string_view text);
    std::string_view view() const;
    bool empty() const { return text.front() == 0; }
    bool well_formed() const { return of(view()) == *this; }
    bool operator==(const NetworkName&) const = default;
};

struct Header {
    std::uint64_t instance = 0;  // random per process start: tells a second master from the first
    SessionTime send_time{};     // on the sender's clock
    std::uint32_t sequence = 0;  // per flow, wraps
    std::uint32_t trial = 0;     // 0 before the first trial
    Role sender = Role::kSession;
    bool operator==(const Header&) const = default;
};

// master -> slave_sim, one per encoder sample.
struct NeedleCommand {
    double position_needle_m = 0;           // scale x encoder reading
    double velocity_needle_m_per_s = 0;     // estimated, see velocity_estimator.hpp
    double position_needle_estimate_m = 0;  // the smooth position whose slope is that velocity
    double position_hand_m = 0;             // encoder reading
    double velocity_hand_m_per_s = 0;
    double force_hand_N = 0;  // applied by the handle, positive pushes the hand out (towards -z)
    bool operator==(const NeedleCommand&) const = default;
};

// slave_sim -> master, cutaneous_node, visual_node and the session's recorder: the answer to one command.
struct ForceFeedback {
    double position_needle_m = 0;  // undelayed, as commanded
    double position_surface_m = 0;
    double velocity_surface_m_per_s = 0;
    double position_proxy_m = 0;  // god-object, min(needle, fixture)
    double force_tissue_N = 0;    // on the operator: negative resists insertion
    double force_fixture_N = 0;
    double force_total_N = 0;
    double contact_time_s = 0;        // unbroken contact with the fixture
    SessionTime echo_time{};          // the command's send time, on the master's clock
    Duration hold_time{};             // from the command's arrival to this answer
    std::uint32_t echo_sequence = 0;  // the command's sequence
    TissuePhase phase = TissuePhase::kFree;
    bool fixture_present = true;
    bool needle_held = false;  // commands stopped: needle stands still, every force is zero
    bool operator==(const ForceFeedback&) const = default;
};

// cutaneous_node, visual_node -> the virtual operator: what skin and eyes get. Never delayed by the network.
struct Percept {
    double force_N = 0;  // pressed on the finger by the actuator, >= 0
    double bar_N = 0;    // shown by the bar, >= 0
    double position_needle_shown_m = 0;
    double position_surface_shown_m = 0;
    double sample_age_s = 0;
    Finger finger = Finger::kNone;
    bool touching_shown = false;  // the needle is seen to touch or enter the tissue
    bool beep = false;
    bool operator==(const Percept&) const = default;
};

// session -> every node; slave_sim -> visual_node and session for kBeep.
struct SessionControl {
    std::uint64_t study_seed = 0;
    double fixture_position_m = 0;
    // TrialStart: both ways together, as configured: how long the first answer may take. NetworkChange: of the force path.
    double network_delay_s = 0;
    std::uint32_t subject = 0;
    std::uint32_t experiment = 0;
    ControlKind kind = ControlKind::kTrialStart;
    Modality modality = Modality::kHF;
    bool fixture_present = true;
    EndReason reason = EndReason::kNone;
    double silence_s = 0;   // NetworkChange: both ways, jitter included; so long an input may be silent
    NetworkName network{};  // NetworkChange: the profile that holds, with network_delay_s on the force path
    bool operator==(const SessionControl&) const = default;
};

// every node -> session, at 10 Hz and at once after each SessionControl (it is the acknowledgement).
struct Heartbeat {
    std::uint64_t accepted = 0;
    std::uint64_t refused = 0;
    double round_trip_median_s =
        0;  // master: encoder sample to its force at the handle, this trial; others 0
    double round_trip_worst_s = 0;
    double hold_median_s = 0;  // the part of it spent inside slave_sim
    double force_hand_N = 0;   // master: what the handle applies now; others 0
    // master: work of the hand on the handle in this trial, until now, = sum of force x way of the samples; negative:
    // the handle has given out more than it got (Hannaford and Ryu 2002); others 0
    double energy_in_J = 0;
    NodeState state = NodeState::kIdle;
    EndReason reason = EndReason::kNone;
    bool operator==(const Heartbeat&) const = default;
};

// session -> every node, on the control channel: what does your clock say? (clock_prober.hpp)
struct ClockProbe {
    SessionTime send_time{};  // on the asker's clock
    bool operator==(const ClockProbe&) const = default;
};

// The answer, in the tick in which the probe arrived. When it was sent says its header.
struct ClockReply {
    SessionTime probe_send_time{};     // which probe
    SessionTime probe_arrival_time{};  // on the replier's clock, never earlier than it came
    bool operator==(const ClockReply&) const = default;
};

// visual_node -> master: where a person's hand is, by mouse, trackpad or gamepad. Never delayed by the network.
struct HandInput {
    double position_hand_m = 0;  // where the hand wants the handle
    bool engaged = false;        // false: it has let go
    bool operator==(const HandInput&) const = default;
};

// session -> the experimenter's view, at most 250 Hz. Undelayed truth, with the fixture: never to the subject's.
struct Monitor {
    double time_s = 0;  // since the start of the trial, on the master's clock
    double position_needle_m = 0;
    double position_surface_m = 0;
    double position_fixture_m = 0;
    double force_tissue_N = 0;  // on the operator, negative resists insertion
    double force_fixture_N = 0;
    double force_total_N = 0;
    double contact_time_s = 0;
    double force_hand_N = 0;  // as in Heartbeat
    double energy_in_J = 0;
    double round_trip_s = 0;     // newest, handle to handle; 0: not known yet
    double one_way_s = -1;       // slave_sim to master by the clocks; negative: not known
    double one_way_bound_s = 0;  // by how much that may be wrong
    double network_delay_s = 0;  // as asked now, one way
    std::uint64_t accepted = 0;  // datagrams, all nodes since their start
    std::uint64_t refused = 0;
    std::uint32_t subject = 0;
    std::uint32_t trials = 0;  // planned; 0: no plan
    TissuePhase phase = TissuePhase::kFree;
    Modality modality = Modality::kHF;
    NodeState state = NodeState::kIdle;  // kRunning while a trial runs
    EndReason reason = EndReason::kNone;
    bool fixture_present = true;
    bool needle_held = false;
    bool beeped = false;
    bool paused = false;
    NetworkName network{};  // the profile that holds, its force path at network_delay_s
    bool operator==(const Monitor&) const = default;
};

// A view -> session.
struct Order {
    double value = 0;
    std::uint32_t trial = 0;
    OrderKind kind = OrderKind::kDelay;
    Modality modality = Modality::kHF;
    NetworkName network{};
    bool operator==(const Order&) const = default;
};

// session -> visual_node, on its control channel.
struct Page {
    double remaining_s = 0;    // of a break; 0: until a key is pressed
    std::uint32_t trial = 0;   // the coming one; of kQuestion: which question of the page set, from 1
    std::uint32_t trials = 0;  // in all; for kQuestion the checksum of the page set
    PageKind kind = PageKind::kNone;
    bool operator==(const Page&) const = default;
};

// A replay -> the view that watches it.
struct ReplayState {
    static constexpr std::size_t kMostChanges = 16;

    double duration_s = 0;
    double speed = 1;
    double contact_s = -1;                        // needle and tissue first touched; negative: never
    double beep_s = -1;                           // negative: no beep
    std::array<double, kMostChanges> change_s{};  // when the network changed, in order
    std::uint32_t changes = 0;                    // how many of them; the rest is 0
    bool operator==(const ReplayState&) const = default;
};

// A node whose device has failed -> session, behind each heartbeat that says kDeviceFault; and of a stop (is_stop), who and why.
struct DeviceFault {
    std::array<char, 320> text{};  // which device, why, what to do; UTF-8, zeros behind its end

    DeviceFault() = default;
    explicit DeviceFault(std::string_view words);  // cut where it is too long
    std::string_view words() const;
    bool operator==(const DeviceFault&) const = default;
};

// Wave variables as they travel: the newest sample's and those of a few samples before it, so that single losses lose
// nothing. A wave has the unit of a root of power; what travels in h is its square, half of it.
struct WaveBurst {
    static constexpr std::size_t kMost = 8;

    std::array<double, kMost> wave_root_W{};  // newest first
    double sum_root_W_s = 0;                  // of all waves until the newest, x h
    double energy_J = 0;                      // of all waves until the newest, sum of u^2 h / 2
    std::uint32_t number = 0;                 // of the newest, from 0 in each trial
    std::uint32_t count = 0;                  // how many there are, at most kMost

    bool operator==(const WaveBurst&) const = default;
};

// With [control] compensator = "wave" in HF these two go instead of a NeedleCommand, and of the ForceFeedback to the master.
struct NeedleWave {
    NeedleCommand command;
    WaveBurst waves;
    bool operator==(const NeedleWave&) const = default;
};
struct ForceWave {
    ForceFeedback feedback;
    WaveBurst waves;
    bool operator==(const ForceWave&) const = default;
};

// A program that stops everything -> all programs. Also a release, and the question which stops are held (stop_bus.hpp).
struct StopOrder {
    std::uint64_t id = 0;  // of a stop and of a question: random; of a release: the stop's
    std::uint32_t held_ms =
        0;  // of an answer to a question: for how long it has been held there; otherwise 0
    StopKind kind = StopKind::kStop;
    EndReason reason = EndReason::kEmergencyStop;
    std::array<char, 154> text{};  // who and why; UTF-8, zeros behind its end

    StopOrder() = default;
    StopOrder(std::uint64_t number, StopKind what, EndReason why, std::string_view words);
    std::string_view words() const;
    bool operator==(const StopOrder&) const = default;
};

// Order as in Packet of messages.fbs.
using Body =
    std::variant<NeedleCommand, ForceFeedback, Percept, SessionControl, Heartbeat, ClockProbe, ClockReply,
                 HandInput, Monitor, Order, Page, ReplayState, DeviceFault, NeedleWave, ForceWave, StopOrder>;

struct Message {
    Header header;
    Body body;
    bool operator==(const Message&) const = default;
};

const char* to_string(Role role);
const char* to_string(Modality modality);
std::optional<Modality> find_modality(std::string_view text);  // "HF", as to_string writes it
const char* to_string(TissuePhase phase);
const char* to_string(EndReason reason);
const char* to_string(NodeState state);

}  // namespace thimble
