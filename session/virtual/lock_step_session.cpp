#include "session/virtual/lock_step_session.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <sys/socket.h>
#include <unistd.h>

#include "common/runtime/log/message_log.hpp"
#include "common/runtime/protection.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

// Data at these ports make their node send nothing before it is due. netem and slave_sim answer at once, so theirs are missing.
constexpr std::array kQuietPorts{Port::kMasterForce,         Port::kMasterPerceptCutaneous,
                                 Port::kMasterPerceptVisual, Port::kCutaneousForce,
                                 Port::kVisualForce,         Port::kVisualScene};

// The session's own process, in the conductor itself.
class CountedProcess final : public Process {
  public:
    // `log`: null, if there is none.
    CountedProcess(Process& process, Sockets& sockets, AnnouncedMail& mail, MessageLog* log)
        : process_(process), sockets_(sockets), mail_(mail), log_(log) {}

    void tick(SessionTime now) override {
        if (log_ != nullptr) log_->take_time(now);
        DatagramCounts arrived{};
        mail_.take(Role::kSession, arrived);
        sockets_.announce(arrived);
        try {
            process_.tick(now);
        } catch (const DatagramLost& lost) {
            lost_ = LostNode{flow(lost.port()).hears, lost.what()};
        }
        mail_.post(sockets_.take_sent());
    }
    const std::optional<LostNode>& lost() const { return lost_; }
    SessionTime next_wakeup() const override { return process_.next_wakeup(); }
    bool stopped() const override { return false; }

  private:
    Process& process_;
    Sockets& sockets_;
    AnnouncedMail& mail_;
    MessageLog* log_;
    std::optional<LostNode> lost_;  // a datagram, and its sender
};

constexpr Duration kLookAtMachines = std::chrono::milliseconds{20};

void look_at_machines() {
    wall_sleep(kLookAtMachines);
    if (stop_requested()) throw Error(ExitCode::kRunFailed, "interrupted before the first trial");
}

std::size_t index_of(Role role) {
    return static_cast<std::size_t>(std::find(kNodeRoles.begin(), kNodeRoles.end(), role) -
                                    kNodeRoles.begin());
}

std::unique_ptr<MessageLog> log_of(const ConditionPlan& plan) {
    return plan.log.messages == LoggedMessages::kNone ? nullptr : std::make_unique<MessageLog>();
}

Sockets counted_sockets(const ConditionPlan& plan, MessageLog* log) {
    Sockets sockets(without_user_key(plan.network));
    sockets.count_datagrams(plan.datagram_limit());
    if (log != nullptr) sockets.record_to(*log, plan.log.messages == LoggedMessages::kAll);
    return sockets;
}

class LockStepSession final : public SteppedSession {
  public:
    explicit LockStepSession(LockStepNodes& nodes)
        : nodes_(nodes),
          log_(log_of(nodes.plan())),
          sockets_(counted_sockets(nodes.plan(), log_.get())),
          session_(granted_instance(Role::kSession), nodes.plan().session, sockets_) {
        if (sockets_.security() != nullptr) secured_.emplace(session_, *sockets_.security());
        Process& outer = secured_ ? static_cast<Process&>(*secured_) : session_;
        own_.emplace(outer, sockets_, mail_, log_.get());
        begin();
    }

    SessionProcess& session() override { return session_; }
    SessionTime now() const override { return loop_.now(); }
    const std::optional<LostNode>& lost() const override { return lost_; }
    std::string fault() const override { return log_ ? std::string(log_->fault()) : std::string(); }
    void look_outside() override {
        if (sockets_.hear_outside(Port::kSessionStop)) loop_.poke(own_bit_);
    }

    std::vector<DueProgram> due() const override {
        std::vector<DueProgram> programs{{Role::kSession, getpid(), own_->next_wakeup()}};
        programs.reserve(kNodes.size() + 1);
        for (const auto& node : granted_)
            programs.push_back({node->role(), nodes_.pid(index_of(node->role())), node->next_wakeup()});
        return programs;
    }

    void start(const TrialConditions& conditions) override {
        if (log_) start_log(conditions);
        const Security* const security = sockets_.security();
        for (int i = 0; security != nullptr && !security->complete(); ++i) {
            if (i <= kMostInstantsForKeys && loop_.step() && !look_for_lost()) continue;
            throw Error(
                failure(), "{}",
                lost_ ? lost_->words : "cannot give the programs their keys: " + security->complaint());
        }
        session_.start(conditions);
        loop_.poke(own_bit_);
    }

    bool step() override {
        if (!session_.finished() && loop_.step()) {
            look_for_lost();
            return true;
        }
        if (log_) log_->close();  // here, because its last bytes may not fit on the disk
        return false;
    }

  private:
    void start_log(const TrialConditions& conditions) {
        const auto file = log_path_of_trial(nodes_.session_log(), conditions.trial);
        remove_file(file);
        log_->take_time({});
        log_->start(file, {"session", nodes_.plan().session_file, {}}, nodes_.plan().log);
        log_->note("trial", trial_note(conditions, conditions.trial, {}));
    }

    // All programs make themselves new at the same time. No program sends before all of them listen.
    void begin() {
        own_bit_ = loop_.add(*own_);
        granted_.reserve(kNodes.size());
        mail_.wake(Role::kSession, own_bit_);
        for (const Role role : kTickOrder)
            granted_.push_back(std::make_unique<GrantedProcess>(role, nodes_.of(index_of(role)), mail_));
        for (const auto& node : granted_) node->begin(nodes_.plan().datagram_limit());
        for (const auto& node : granted_) {
            node->await_ready();
            if (look_for_lost()) throw Error(failure(), lost_->words);
            mail_.wake(node->role(), loop_.add(*node));
        }
    }

    // The first is the cause: of others it may be a consequence.
    bool look_for_lost() {
        if (!lost_) lost_ = own_->lost();
        if (lost_) return true;
        for (const auto& node : granted_) {
            if (!node->silence()) continue;
            lost_ = nodes_.lost(node->role(), *node->silence(), loop_.now());
            return true;
        }
        return false;
    }

    ExitCode failure() const {
        if (stop_requested()) return ExitCode::kRunFailed;
        return lost_ ? lost_->code : ExitCode::kNetwork;
    }

    LockStepNodes& nodes_;
    std::unique_ptr<MessageLog> log_;  // of this trial
    Sockets sockets_;
    SessionProcess session_;
    std::optional<SecuredProcess> secured_;
    VirtualLoop loop_;
    AnnouncedMail mail_{loop_.wake_mask()};
    std::optional<CountedProcess> own_;
    std::vector<std::unique_ptr<GrantedProcess>> granted_;
    std::uint32_t own_bit_ = 0;
    std::optional<LostNode> lost_;
};

}  // namespace

// Each force for visual has a picture beside it, and a beep goes to the picture's port alone: then more go there.
// With [codec] force more go there without a beep, too: a full grant instead of a quiet one changes no result.
void AnnouncedMail::post(std::span<const std::uint16_t> sent) {
    beep_ = beep_ || sent[static_cast<std::size_t>(Port::kVisualScene)] >
                         sent[static_cast<std::size_t>(Port::kNetemForceVisual)];
    for (const Port port : kEveryPort) {
        const auto i = static_cast<std::size_t>(port);
        if (sent[i] == 0) continue;
        waiting_[i] = static_cast<std::uint16_t>(waiting_[i] + sent[i]);
        *woken_ |= bits_[static_cast<std::size_t>(owner(port))];
    }
}

void AnnouncedMail::take(Role role, std::span<std::uint16_t> datagrams) {
    if (role == Role::kVisual) beep_ = false;
    for (const Port port : kEveryPort) {
        const auto i = static_cast<std::size_t>(port);
        if (waiting_[i] > 0 && owner(port) == role)
            datagrams[i] = std::exchange(waiting_[i], std::uint16_t{0});
    }
}

bool AnnouncedMail::only_data(Role role) const {
    const auto wants_answer = [this, role](Port port) {
        return owner(port) == role && waiting_[static_cast<std::size_t>(port)] > 0 &&
               std::find(kQuietPorts.begin(), kQuietPorts.end(), port) == kQuietPorts.end();
    };
    const bool beep = role == Role::kVisual && beep_;
    return !beep && std::none_of(kEveryPort.begin(), kEveryPort.end(), wants_answer);
}

void GrantedProcess::begin(Duration limit) {
    LockStepMessage order;
    order.kind = LockStepKind::kBegin;
    order.time_ns = limit.count() / 2;  // it can still say which datagram did not come
    order.instance = granted_instance(role_);
    if (!end_.send(order)) lose(LockStepEnd::Silence::kGone);
}

void GrantedProcess::tick(SessionTime now) {
    LockStepMessage grant;
    const bool quiet = may_be_quiet(now);
    grant.kind = quiet ? LockStepKind::kQuietGrant : LockStepKind::kGrant;
    grant.time_ns = to_nanoseconds(now);
    quiet_ = quiet ? quiet_ + 1 : 0;
    mail_.take(role_, grant.datagrams);
    if (silence_) return;
    if (!end_.send(grant)) return lose(LockStepEnd::Silence::kGone);
    if (quiet) return;
    take(LockStepKind::kAnswer);
    due_at_once_ = next_ <= now ? due_at_once_ + 1 : 0;
    if (due_at_once_ > kMostDueAtOnce)
        throw Error(ExitCode::kNetwork,
                    "lock-step: {} has asked {} times in a row for its next event at {} s, which is now: it "
                    "must ask for a later time, or for none",
                    to_string(role_), due_at_once_, to_seconds(now.time_since_epoch()));
}

// Between two frames, samples or percepts data change the next one, and nothing else.
bool GrantedProcess::may_be_quiet(SessionTime now) const {
    return now < std::min(next_, quiet_until_) && quiet_ < kMostQuiet && mail_.only_data(role_);
}

std::optional<LockStepMessage> GrantedProcess::receive() {
    try {
        return end_.receive();
    } catch (const Error& error) {
        throw Error(error.code(), "{} sends {}", to_string(role_), error.what());
    }
}

void GrantedProcess::take(LockStepKind expected) {
    if (silence_) return;
    const auto answer = receive();
    if (!answer) return lose(end_.silence());
    if (answer->kind != expected)
        throw Error(ExitCode::kNetwork, "lock-step: {} sent an answer of kind {} instead of {}",
                    to_string(role_), static_cast<int>(answer->kind), static_cast<int>(expected));
    next_ = from_nanoseconds(answer->time_ns);
    quiet_until_ = from_nanoseconds(static_cast<std::int64_t>(answer->instance));
    mail_.post(answer->datagrams);
}

void GrantedProcess::lose(LockStepEnd::Silence silence) {
    silence_ = silence;
    next_ = kNever;
}

// The first place has the core that this program happens to be on: so programs side by side spread.
CoreLease::CoreLease(unsigned place) {
    static const int first = sched_getcpu();
    sched_getaffinity(0, sizeof before_, &before_);
    std::vector<int> cores;
    cores.reserve(CPU_SETSIZE);
    for (int core = 0; core < CPU_SETSIZE; ++core) {
        if (CPU_ISSET(core, &before_)) cores.push_back(core);
    }
    if (cores.empty()) return;  // more cores than this set has room for
    const auto here = std::find(cores.begin(), cores.end(), first) - cores.begin();
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(cores[(static_cast<std::size_t>(here) + place) % cores.size()], &one);
    sched_setaffinity(0, sizeof one, &one);
}

LockStepNodes::LockStepNodes(const ConditionPlan& plan)
    : plan_(plan), core_(plan.place), files_(plan, false), nodes_(plan, files_) {
    make_folder(plan.out);
    std::optional<GrantDoor> door;
    if (runs_elsewhere(*plan.starter))
        door.emplace(Endpoint{plan.network.host(Role::kSession), plan.network.base_port});
    std::vector<std::unique_ptr<FileDescriptor>> theirs;
    theirs.reserve(kNodes.size());
    std::array<int, kNodes.size()> inputs{};
    inputs.fill(-1);
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        if (!plan.starter->machine(kNodes[i].role).empty()) continue;
        std::array<int, 2> pair{};
        if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair.data()) != 0)
            throw Error(ExitCode::kRunFailed, "cannot make a socket for {}: {}", kNodes[i].program,
                        std::strerror(errno));
        ends_[i] = std::make_unique<LockStepEnd>(pair[0], plan.answer_limit);
        ends_[i]->offer_page();
        theirs.push_back(std::make_unique<FileDescriptor>(pair[1]));
        inputs[i] = pair[1];
    }
    nodes_.launch(inputs, door ? grant_key_text(door->key()) : "");
    if (!door) return;
    nodes_.wait_for_machines(look_at_machines);
    let_in(*door);
    keep_machines();
}

bool LockStepNodes::all_in() const {
    return std::all_of(ends_.begin(), ends_.end(), [](const auto& end) { return end != nullptr; });
}

// Each by the name that it has proved. Once all are in, the port is closed.
void LockStepNodes::let_in(GrantDoor& door) {
    const SessionTime deadline = wall_now() + plan_.starter->reach();
    for (; !all_in(); look_at_machines()) {
        nodes_.throw_if_dead();
        if (wall_now() > deadline)
            throw Error(ExitCode::kNetwork,
                        "a program on another machine has not reached TCP port {} of {} within {} s: does a "
                        "firewall block that port (docs/machines.md)? See the logs in {}",
                        plan_.network.base_port, plan_.network.host(Role::kSession),
                        to_seconds(plan_.starter->reach()), plan_.out.string());
        while (auto stream = door.take()) {
            const auto* const node = std::find_if(kNodes.begin(), kNodes.end(), [&](const NodeKind& kind) {
                return kind.program == stream->program();
            });
            if (node == kNodes.end() || ends_.at(index_of(node->role))) continue;
            ends_.at(index_of(node->role)) =
                std::make_unique<LockStepEnd>(std::move(stream), plan_.answer_limit);
        }
    }
}

void LockStepNodes::keep_machines() {
    kept_ = true;
    keeper_ = std::thread([this] {
        for (; kept_; wall_sleep(kLookAtMachines)) {
            const std::lock_guard guard(mutex_);
            nodes_.dead();  // asks each
        }
    });
}

void LockStepNodes::stop_keeping() {
    kept_ = false;
    if (keeper_.joinable()) keeper_.join();
}

std::unique_ptr<SteppedSession> LockStepNodes::make_session() {
    return std::make_unique<LockStepSession>(*this);
}

LostNode LockStepNodes::lost(Role role, LockStepEnd::Silence silence, SessionTime now) {
    if (silence == LockStepEnd::Silence::kInterrupted) return {role, "interrupted; finished trials are kept"};
    const std::lock_guard guard(mutex_);
    const std::size_t node = index_of(role);
    const std::string& program = nodes_.at(node).program();
    if (silence == LockStepEnd::Silence::kGone) {
        const std::string last = nodes_.last_output(node);
        return last.empty() ? LostNode{role, fmt::format("{} has closed its lock-step connection", program)}
                            : LostNode{role, last, nodes_.verdict(node)};
    }
    nodes_.stop(node);
    return {role,
            fmt::format("{} has not answered within {} s, at {} s of the session's clock: is it paused, or "
                        "in a debugger? See its log in {}, or allow more with --answer-limit-s",
                        program, to_seconds(plan_.answer_limit), to_seconds(now.time_since_epoch()),
                        plan_.out.string())};
}

void LockStepNodes::end(ConditionResult& result) {
    LockStepMessage order;
    order.kind = LockStepKind::kEnd;
    for (const auto& end : ends_) end->send(order);
    stop_keeping();
    nodes_.end(result);
    for (const auto& report : result.reports) {
        const std::string fault = log_fault_in(report);
        if (fault.empty() || result.code != ExitCode::kOk) continue;
        result.code = ExitCode::kRunFailed;
        result.problem = fault;
    }
}

}  // namespace thimble
