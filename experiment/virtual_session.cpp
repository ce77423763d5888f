#include "experiment/virtual_session.hpp"

#include "common/queue_channel.hpp"
#include "cutaneous_node/cutaneous_process.hpp"
#include "cutaneous_node/simulated_actuator.hpp"
#include "master/master_process.hpp"
#include "netem/netem_process.hpp"
#include "slave_sim/slave_process.hpp"
#include "visual_node/recording_display.hpp"
#include "visual_node/visual_process.hpp"

namespace thimble {
namespace {

// Two ends of one pipe; each arrival at an end wakes its owner.
struct Pipe {
    QueueChannel a, b;
    Pipe() {
        a.connect(b);
        b.connect(a);
    }
};

std::uint64_t instance_of(Role role) {
    RandomStream stream({0, 0, 0, static_cast<std::uint32_t>(role), Purpose::kInstance});
    return stream();
}

}  // namespace

struct VirtualSession::Parts {
    explicit Parts(const SystemSettings& s);
    void wire();

    SystemSettings settings;
    // control[i] joins the session (a) with node kNodeRoles[i] (b).
    std::array<Pipe, kNodeRoles.size()> control;
    Pipe record, needle_up, needle_down, force_up_master, force_up_cutaneous, force_up_visual,
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
    VirtualLoop loop;
    std::uint32_t session_bit = 0;
};

VirtualSession::Parts::Parts(const SystemSettings& s)
    : settings(s),
      handle(s.handle, s.person),
      actuator(s.cutaneous),
      display(s.visual.pipeline),
      session(instance_of(Role::kSession), session_settings(s),
              {{&control[0].a, &control[1].a, &control[2].a, &control[3].a, &control[4].a}, &record.b}),
      master(instance_of(Role::kMaster), s.master,
             {&control[4].b, &needle_up.a, &force_down_master.b, &percept_cutaneous.b, &percept_visual.b},
             handle, handle),
      netem(instance_of(Role::kNetem), control[0].b,
            std::vector<RelayPlan>{
                {&needle_up.b, &needle_down.a, s.netem.needle, kDirectionNeedle, s.netem.needle_timeline},
                {&force_up_master.b, &force_down_master.a, s.netem.force, kDirectionForceMaster,
                 s.netem.force_timeline},
                {&force_up_cutaneous.b, &force_down_cutaneous.a, s.netem.force, kDirectionForceCutaneous,
                 s.netem.force_timeline},
                {&force_up_visual.b, &force_down_visual.a, s.netem.force, kDirectionForceVisual,
                 s.netem.force_timeline}}),
      slave(instance_of(Role::kSlaveSim), s.slave,
            {&control[1].b, &needle_down.b, &force_up_master.a, &force_up_cutaneous.a, &force_up_visual.a,
             &beep.a, &record.a}),
      cutaneous(instance_of(Role::kCutaneous), s.cutaneous,
                {&control[2].b, &force_down_cutaneous.b, &percept_cutaneous.a}, actuator),
      visual(instance_of(Role::kVisual), s.visual,
             {&control[3].b, &force_down_visual.b, &beep.b, &percept_visual.a}, display) {
    wire();
}

void VirtualSession::Parts::wire() {
    std::uint32_t* mask = loop.wake_mask();
    session_bit = loop.add(session);
    const std::uint32_t master_bit = loop.add(master);
    const std::uint32_t netem_bit = loop.add(netem);
    const std::uint32_t slave_bit = loop.add(slave);
    const std::uint32_t cutaneous_bit = loop.add(cutaneous);
    const std::uint32_t visual_bit = loop.add(visual);
    const std::array node_bits{netem_bit, slave_bit, cutaneous_bit, visual_bit, master_bit};  // as kNodeRoles
    for (std::size_t i = 0; i < control.size(); ++i) {
        control[i].a.wake(mask, session_bit);
        control[i].b.wake(mask, node_bits[i]);
    }
    record.b.wake(mask, session_bit);
    for (Pipe* up : {&needle_up, &force_up_master, &force_up_cutaneous, &force_up_visual}) {
        up->b.wake(mask, netem_bit);
    }
    needle_down.b.wake(mask, slave_bit);
    for (Pipe* down : {&force_down_master, &percept_cutaneous, &percept_visual})
        down->b.wake(mask, master_bit);
    force_down_cutaneous.b.wake(mask, cutaneous_bit);
    for (Pipe* down : {&force_down_visual, &beep}) down->b.wake(mask, visual_bit);
}

VirtualSession::VirtualSession(const SystemSettings& settings) : parts_(std::make_unique<Parts>(settings)) {}
VirtualSession::~VirtualSession() = default;

void VirtualSession::start(const TrialConditions& conditions) {
    parts_->session.start(conditions);
    parts_->loop.poke(parts_->session_bit);
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

SessionProcess& VirtualSession::session() { return parts_->session; }
const SimulatedHandle& VirtualSession::handle() const { return parts_->handle; }
const VirtualLoop& VirtualSession::loop() const { return parts_->loop; }

TrialRecord run_virtual_trial(const SystemSettings& settings, const TrialConditions& conditions) {
    SystemSettings with_delay = settings;
    set_delay(with_delay.netem.force, with_delay.netem.force_timeline, from_seconds(conditions.delay_s));
    VirtualSession session(with_delay);
    return session.run(conditions);
}

}  // namespace thimble
