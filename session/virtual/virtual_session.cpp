#include "session/virtual/virtual_session.hpp"

#include <algorithm>
#include <stdexcept>

#include "common/queue_channel.hpp"
#include "cutaneous_node/cutaneous_process.hpp"
#include "cutaneous_node/simulated_actuator.hpp"
#include "master/master_process.hpp"
#include "netem/netem_process.hpp"
#include "session/virtual/virtual_protection.hpp"
#include "session/virtual/virtual_stops.hpp"
#include "slave_sim/slave_process.hpp"
#include "visual_node/recording_display.hpp"
#include "visual_node/visual_process.hpp"

namespace thimble {
namespace {

std::uint64_t instance_of(Role role) {
    RandomStream stream({0, 0, 0, static_cast<std::uint32_t>(role), Purpose::kInstance});
    return stream();
}

// Nobody needs longer for handshakes without delay.
constexpr int kMostInstantsForKeys = 100;

}  // namespace

struct VirtualSession::Parts {
    Parts(const SystemSettings& s, const std::shared_ptr<const LabKey>& lab);
    void wire();
    std::uint32_t add(Process& process, Role role);
    NodeProcess& node(Role role);

    SystemSettings settings;
    VirtualProtection protection;
    // control[i] joins the session (a) with node kNodeRoles[i] (b).
    std::array<QueuePipe, kNodeRoles.size()> control;
    QueuePipe record, needle_up, needle_down, force_up_master, force_up_cutaneous, force_up_visual,
        force_down_master, force_down_cutaneous, force_down_visual, beep, percept_cutaneous, percept_visual;
    SimulatedHandle handle;
    SimulatedActuator actuator;
    RecordingDisplay display;
    SessionProcess session;
    MasterProcess master;
    NetemProcess netem;
    SlaveProcess slave;
    CutaneousProcess cutaneous;
    VisualProcess visual;
    std::vector<std::unique_ptr<SecuredProcess>> secured;
    VirtualLoop loop;
    VirtualStops stops;
    std::array<std::uint32_t, kRoleCount> bits{};  // by Role
};

VirtualSession::Parts::Parts(const SystemSettings& s, const std::shared_ptr<const LabKey>& lab)
    : settings(s),
      protection(lab),
      handle(s.handle, s.person),
      actuator(s.cutaneous),
      display(s.visual.pipeline),
      session(instance_of(Role::kSession), session_settings(s),
              {{protection.pair(control[0].a, Port::kSessionNetem, Port::kNetemControl),
                protection.pair(control[1].a, Port::kSessionSlave, Port::kSlaveControl),
                protection.pair(control[2].a, Port::kSessionCutaneous, Port::kCutaneousControl),
                protection.pair(control[3].a, Port::kSessionVisual, Port::kVisualControl),
                protection.pair(control[4].a, Port::kSessionMaster, Port::kMasterControl)},
               protection.inlet(record.b, Port::kSessionRecord)}),
      master(instance_of(Role::kMaster), s.master,
             {protection.pair(control[4].b, Port::kMasterControl, Port::kSessionMaster),
              protection.outlet(Role::kMaster, needle_up.a, Port::kNetemNeedle),
              protection.inlet(force_down_master.b, Port::kMasterForce),
              protection.inlet(percept_cutaneous.b, Port::kMasterPerceptCutaneous),
              protection.inlet(percept_visual.b, Port::kMasterPerceptVisual)},
             handle, handle),
      netem(instance_of(Role::kNetem),
            *protection.pair(control[0].b, Port::kNetemControl, Port::kSessionNetem),
            std::vector<RelayPlan>{
                {&needle_up.b, &needle_down.a, s.netem.needle, kDirectionNeedle, s.netem.needle_timeline},
                {&force_up_master.b, &force_down_master.a, s.netem.force, kDirectionForceMaster,
                 s.netem.force_timeline},
                {&force_up_cutaneous.b, &force_down_cutaneous.a, s.netem.force, kDirectionForceCutaneous,
                 s.netem.force_timeline},
                {&force_up_visual.b, &force_down_visual.a, s.netem.force, kDirectionForceVisual,
                 s.netem.force_timeline}}),
      slave(instance_of(Role::kSlaveSim), s.slave,
            {protection.pair(control[1].b, Port::kSlaveControl, Port::kSessionSlave),
             protection.inlet(needle_down.b, Port::kSlaveNeedle),
             protection.outlet(Role::kSlaveSim, force_up_master.a, Port::kNetemForceMaster),
             protection.outlet(Role::kSlaveSim, force_up_cutaneous.a, Port::kNetemForceCutaneous),
             protection.outlet(Role::kSlaveSim, force_up_visual.a, Port::kNetemForceVisual),
             protection.outlet(Role::kSlaveSim, beep.a, Port::kVisualBeep),
             protection.outlet(Role::kSlaveSim, record.a, Port::kSessionRecord)}),
      cutaneous(instance_of(Role::kCutaneous), s.cutaneous,
                {protection.pair(control[2].b, Port::kCutaneousControl, Port::kSessionCutaneous),
                 protection.inlet(force_down_cutaneous.b, Port::kCutaneousForce),
                 protection.outlet(Role::kCutaneous, percept_cutaneous.a, Port::kMasterPerceptCutaneous)},
                actuator),
      visual(instance_of(Role::kVisual), s.visual,
             {protection.pair(control[3].b, Port::kVisualControl, Port::kSessionVisual),
              protection.inlet(force_down_visual.b, Port::kVisualForce),
              protection.inlet(beep.b, Port::kVisualBeep),
              protection.outlet(Role::kVisual, percept_visual.a, Port::kMasterPerceptVisual)},
             display) {
    wire();
}

std::uint32_t VirtualSession::Parts::add(Process& process, Role role) {
    Security* const security = protection.of(role);
    if (security == nullptr) return loop.add(process);
    return loop.add(*secured.emplace_back(std::make_unique<SecuredProcess>(process, *security)));
}

void VirtualSession::Parts::wire() {
    std::uint32_t* mask = loop.wake_mask();
    const std::uint32_t session_bit = add(session, Role::kSession);
    const std::uint32_t master_bit = add(master, Role::kMaster);
    const std::uint32_t netem_bit = add(netem, Role::kNetem);
    const std::uint32_t slave_bit = add(slave, Role::kSlaveSim);
    const std::uint32_t cutaneous_bit = add(cutaneous, Role::kCutaneous);
    const std::uint32_t visual_bit = add(visual, Role::kVisual);
    const std::array node_bits{netem_bit, slave_bit, cutaneous_bit, visual_bit, master_bit};  // as kNodeRoles
    for (std::size_t i = 0; i < control.size(); ++i) {
        control[i].a.wake(mask, session_bit);
        control[i].b.wake(mask, node_bits[i]);
    }
    record.b.wake(mask, session_bit);
    for (QueuePipe* up : {&needle_up, &force_up_master, &force_up_cutaneous, &force_up_visual}) {
        up->b.wake(mask, netem_bit);
    }
    needle_down.b.wake(mask, slave_bit);
    for (QueuePipe* down : {&force_down_master, &percept_cutaneous, &percept_visual})
        down->b.wake(mask, master_bit);
    force_down_cutaneous.b.wake(mask, cutaneous_bit);
    for (QueuePipe* down : {&force_down_visual, &beep}) down->b.wake(mask, visual_bit);
    bits[static_cast<std::size_t>(Role::kSession)] = session_bit;
    stops.join(session, Role::kSession, protection, mask, session_bit);
    for (std::size_t i = 0; i < kNodeRoles.size(); ++i) {
        bits[static_cast<std::size_t>(kNodeRoles[i])] = node_bits[i];
        stops.join(node(kNodeRoles[i]), kNodeRoles[i], protection, mask, node_bits[i]);
    }
}

NodeProcess& VirtualSession::Parts::node(Role role) {
    const std::array<NodeProcess*, kNodeRoles.size()> nodes{&netem, &slave, &cutaneous, &visual, &master};
    const auto place = std::find(kNodeRoles.begin(), kNodeRoles.end(), role) - kNodeRoles.begin();
    return *nodes.at(static_cast<std::size_t>(place));
}

VirtualSession::VirtualSession(const SystemSettings& settings, const std::shared_ptr<const LabKey>& lab)
    : parts_(std::make_unique<Parts>(settings, lab)) {}
VirtualSession::~VirtualSession() = default;

void VirtualSession::start(const TrialConditions& conditions) {
    const Security* const security = parts_->protection.of(Role::kSession);
    for (int i = 0; security != nullptr && !security->complete(); ++i) {
        if (i > kMostInstantsForKeys) throw std::logic_error("the nodes do not get their keys");
        parts_->loop.step();
    }
    parts_->session.start(conditions);
    parts_->loop.poke(parts_->bits[static_cast<std::size_t>(Role::kSession)]);
}

bool VirtualSession::step() {
    if (parts_->session.finished()) return false;
    return parts_->loop.step();
}

const TrialRecord& VirtualSession::run(const TrialConditions& conditions) {
    start(conditions);
    while (step()) {
    }
    return parts_->session.record();
}

void VirtualSession::emergency_stop(Role at, std::string_view words) {
    const SessionTime now = parts_->loop.now();
    if (at == Role::kSession) {
        parts_->session.emergency_stop(now, words);
    } else {
        parts_->node(at).stop_everything(now, EndReason::kEmergencyStop, words);
    }
    parts_->loop.poke(parts_->bits.at(static_cast<std::size_t>(at)));
}

void VirtualSession::release_stop() {
    parts_->session.release_stop(parts_->loop.now());
    parts_->loop.poke(parts_->bits[static_cast<std::size_t>(Role::kSession)]);
}

void VirtualSession::idle(Duration limit) {
    const SessionTime end = parts_->loop.now() + limit;
    while (parts_->loop.now() < end && parts_->loop.step()) {
    }
}

const NodeProcess& VirtualSession::node(Role role) const { return parts_->node(role); }
SessionProcess& VirtualSession::session() { return parts_->session; }
const SimulatedHandle& VirtualSession::handle() const { return parts_->handle; }
const VirtualLoop& VirtualSession::loop() const { return parts_->loop; }
SecurityCounters VirtualSession::security() const { return parts_->protection.counters(); }

TrialRecord run_virtual_trial(const SystemSettings& settings, const TrialConditions& conditions) {
    SystemSettings with_delay = settings;
    set_delay(with_delay.netem.force, with_delay.netem.force_timeline, from_seconds(conditions.delay_s));
    VirtualSession session(with_delay);
    return session.run(conditions);
}

}  // namespace thimble
