#include "tests/scenario/rig.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "common/network_settings.hpp"
#include "cutaneous_node/can/cannelloni.hpp"
#include "cutaneous_node/drive_actuator.hpp"

namespace thimble::test {
namespace {

std::uint64_t instance_of(Role role) { return 1000 + static_cast<std::uint64_t>(role); }

}  // namespace

// A screen that is read, and a key beside it.
class ReadDisplay final : public Display {
  public:
    explicit ReadDisplay(Duration pipeline) : frames(pipeline) {}
    void draw(SessionTime now, const Scene& scene) override { frames.draw(now, scene); }
    std::optional<ShownScene> shown(SessionTime now) override { return frames.shown(now); }
    SessionTime next_shown() const override { return frames.next_shown(); }
    void turn_page(SessionTime, const Page& turned) override { page = turned; }
    void beep(SessionTime now) override { frames.beep(now); }
    bool take_go_on() override { return std::exchange(pressed, false); }
    bool take_stop() override { return frames.take_stop(); }

    RecordingDisplay frames;
    Page page;
    bool pressed = false;
};

struct Rig::Parts {
    // The actuator, its drives and the bus between them.
    struct Driven {
        explicit Driven(const CutaneousSettings& s)
            : drives(s.drives.master.nodes, PlantParameters{}, far),
              actuator(s.drives, s.force_limit_N, near) {}

        QueuePipe bus;
        CannelloniBus near{bus.a}, far{bus.b};
        EmulatedDrives drives;
        DriveActuator actuator;
    };

    // Keeps its place in the loop while what runs in it is replaced.
    class Replaceable final : public Process {
      public:
        void tick(SessionTime now) override { process->tick(now); }
        SessionTime next_wakeup() const override { return process->next_wakeup(); }
        bool stopped() const override { return process->stopped(); }

        std::unique_ptr<MasterProcess> process;
    };

    Parts(const SystemSettings& s, const MakeTap& tap, const std::optional<LinkSettings>& kinesthetic);
    void wire();
    void wire_stop_line(std::uint32_t* mask, const std::array<std::uint32_t, 6>& who);
    StopOutlets outlets();
    void join_master();
    Channel* tapped(Wire wire, Channel& end);
    MasterProcess::Channels master_channels();
    std::unique_ptr<MasterProcess> make_master(std::uint64_t instance);

    const MakeTap& make_tap;  // during construction
    std::vector<std::unique_ptr<Tap>> taps;
    SystemSettings settings;
    std::array<QueuePipe, kNodeRoles.size()> control;  // a: session, b: node, in the order of kNodeRoles
    std::array<Channel*, kNodeRoles.size()> orders{}, heartbeats{};
    QueuePipe record, needle_up, needle_down, force_up_master, force_up_cutaneous, force_up_visual,
        force_down_master, force_down_cutaneous, force_down_visual, beep, percept_cutaneous, percept_visual,
        hand;
    std::array<QueuePipe, 6> stop;  // b: who hears, in the order of kStopPorts
    std::array<std::uint32_t, kRoleCount> bits{};
    SimulatedHandle handle;
    BreakableHandle breakable{handle};
    PointerHandle pointer;
    SimulatedActuator actuator;
    std::unique_ptr<Driven> driven;
    ReadDisplay display;
    std::unique_ptr<SessionProcess> session;
    Replaceable master;
    std::unique_ptr<NetemProcess> netem;
    std::unique_ptr<SlaveProcess> slave;
    std::unique_ptr<CutaneousProcess> cutaneous;
    std::unique_ptr<VisualProcess> visual;
    VirtualLoop loop;
    std::uint32_t session_bit = 0, master_bit = 0;
};

HandleSample BreakableHandle::read(SessionTime now) {
    HandleSample sample = inner_->read(now);
    sample.valid = words.empty();
    return sample;
}

Channel* Rig::Parts::tapped(Wire wire, Channel& end) {
    auto tap = make_tap ? make_tap(wire, end) : nullptr;
    if (!tap) return &end;
    taps.push_back(std::move(tap));
    return taps.back().get();
}

MasterProcess::Channels Rig::Parts::master_channels() {
    return {heartbeats[4], &needle_up.a, &force_down_master.b, &percept_cutaneous.b, &percept_visual.b};
}

std::unique_ptr<MasterProcess> Rig::Parts::make_master(std::uint64_t instance) {
    if (settings.handle.kind == HandleKind::kSimulated) {
        return std::make_unique<MasterProcess>(instance, settings.master, master_channels(), breakable,
                                               handle);
    }
    auto process =
        std::make_unique<MasterProcess>(instance, settings.master, master_channels(), pointer, pointer);
    process->follow_hand(hand.b, pointer);
    return process;
}

Rig::Parts::Parts(const SystemSettings& s, const MakeTap& tap, const std::optional<LinkSettings>& kinesthetic)
    : make_tap(tap),
      settings(s),
      handle(s.handle, s.person),
      pointer(s.handle),
      actuator(s.cutaneous),
      display(s.visual.pipeline) {
    if (s.cutaneous.device == FingertipDevice::kDrives) driven = std::make_unique<Driven>(s.cutaneous);
    for (std::size_t i = 0; i < control.size(); ++i) {
        orders[i] = tapped(Wire::kOrders, control[i].a);
        heartbeats[i] = tapped(Wire::kHeartbeats, control[i].b);
    }
    const LinkSettings to_handle = kinesthetic.value_or(s.netem.force);
    session = std::make_unique<SessionProcess>(instance_of(Role::kSession), session_settings(s),
                                               SessionProcess::Channels{orders, &record.b});
    master.process = make_master(instance_of(Role::kMaster));
    netem = std::make_unique<NetemProcess>(
        instance_of(Role::kNetem), *heartbeats[0],
        std::vector<RelayPlan>{
            {&needle_up.b, tapped(Wire::kNeedle, needle_down.a), s.netem.needle, kDirectionNeedle},
            {&force_up_master.b, tapped(Wire::kForceMaster, force_down_master.a), to_handle,
             kDirectionForceMaster},
            {&force_up_cutaneous.b, tapped(Wire::kForceCutaneous, force_down_cutaneous.a), s.netem.force,
             kDirectionForceCutaneous},
            {&force_up_visual.b, tapped(Wire::kForceVisual, force_down_visual.a), s.netem.force,
             kDirectionForceVisual}});
    slave = std::make_unique<SlaveProcess>(
        instance_of(Role::kSlaveSim), s.slave,
        SlaveProcess::Channels{heartbeats[1], &needle_down.b, &force_up_master.a, &force_up_cutaneous.a,
                               &force_up_visual.a, tapped(Wire::kBeep, beep.a),
                               tapped(Wire::kRecord, record.a)});
    cutaneous = std::make_unique<CutaneousProcess>(
        instance_of(Role::kCutaneous), s.cutaneous,
        CutaneousProcess::Channels{heartbeats[2], &force_down_cutaneous.b,
                                   tapped(Wire::kPerceptCutaneous, percept_cutaneous.a)},
        driven ? static_cast<FingertipActuator&>(driven->actuator) : actuator);
    visual = std::make_unique<VisualProcess>(
        instance_of(Role::kVisual), s.visual,
        VisualProcess::Channels{heartbeats[3], &force_down_visual.b, &beep.b,
                                tapped(Wire::kPerceptVisual, percept_visual.a)},
        display);
    wire();
}

void Rig::Parts::wire() {
    std::uint32_t* mask = loop.wake_mask();
    session_bit = loop.add(*session);
    master_bit = loop.add(master);
    const std::uint32_t netem_bit = loop.add(*netem);
    const std::uint32_t slave_bit = loop.add(*slave);
    const std::uint32_t cutaneous_bit = loop.add(*cutaneous);
    const std::uint32_t visual_bit = loop.add(*visual);
    const std::array node_bits{netem_bit, slave_bit, cutaneous_bit, visual_bit, master_bit};  // as kNodeRoles
    if (driven) {
        driven->bus.a.wake(mask, cutaneous_bit);
        driven->bus.b.wake(mask, loop.add(driven->drives));
    }
    for (std::size_t i = 0; i < control.size(); ++i) {
        control[i].a.wake(mask, session_bit);
        control[i].b.wake(mask, node_bits[i]);
    }
    record.b.wake(mask, session_bit);
    for (QueuePipe* up : {&needle_up, &force_up_master, &force_up_cutaneous, &force_up_visual}) {
        up->b.wake(mask, netem_bit);
    }
    needle_down.b.wake(mask, slave_bit);
    for (QueuePipe* down : {&force_down_master, &percept_cutaneous, &percept_visual, &hand})
        down->b.wake(mask, master_bit);
    force_down_cutaneous.b.wake(mask, cutaneous_bit);
    for (QueuePipe* down : {&force_down_visual, &beep}) down->b.wake(mask, visual_bit);
    wire_stop_line(mask, {session_bit, master_bit, slave_bit, cutaneous_bit, visual_bit, netem_bit});
}

void Rig::Parts::wire_stop_line(std::uint32_t* mask, const std::array<std::uint32_t, 6>& who) {
    for (std::size_t i = 0; i < stop.size(); ++i) {
        stop[i].b.wake(mask, who[i]);
        bits[static_cast<std::size_t>(owner(kStopPorts[i]))] = who[i];
    }
    const StopOutlets out = outlets();
    session->join_stop_line(stop[0].b, out);
    join_master();
    slave->join_stop_line(stop[2].b, out);
    cutaneous->join_stop_line(stop[3].b, out);
    visual->join_stop_line(stop[4].b, out);
    netem->join_stop_line(stop[5].b, out);
}

StopOutlets Rig::Parts::outlets() {
    return {&stop[0].a, &stop[1].a, &stop[2].a, &stop[3].a, &stop[4].a, &stop[5].a};
}

void Rig::Parts::join_master() { master.process->join_stop_line(stop[1].b, outlets()); }

Rig::Rig(const SystemSettings& settings, const MakeTap& make_tap,
         const std::optional<LinkSettings>& kinesthetic)
    : parts_(std::make_unique<Parts>(settings, make_tap, kinesthetic)) {}
Rig::~Rig() = default;

void Rig::start(const TrialConditions& conditions) {
    parts_->session->start(conditions);
    parts_->loop.poke(parts_->session_bit);
}

bool Rig::step() { return !parts_->session->finished() && parts_->loop.step(); }

const TrialRecord& Rig::finish() {
    while (step()) {
    }
    return parts_->session->record();
}

const TrialRecord& Rig::run(const TrialConditions& conditions) {
    start(conditions);
    return finish();
}

void Rig::run_until(SessionTime time) {
    while (now() < time && step()) {
    }
}

bool Rig::run_until_sample(const std::function<bool(const TrajectorySample&)>& seen) {
    const auto& samples = session().record().samples;
    std::size_t looked_at = samples.size();
    while (step()) {
        for (; looked_at < samples.size(); ++looked_at) {
            if (seen(samples[looked_at])) return true;
        }
    }
    return false;
}

SessionTime Rig::now() const { return parts_->loop.now(); }
SessionProcess& Rig::session() { return *parts_->session; }
SimulatedHandle& Rig::handle() { return parts_->handle; }
Channel& Rig::hand() { return parts_->hand.a; }
const PointerHandle& Rig::pointer() const { return parts_->pointer; }
const EmulatedDrives& Rig::drives() const { return parts_->driven->drives; }
void Rig::order_drives(const std::string& words) { parts_->driven->drives.obey(now(), words); }
const MasterProcess& Rig::master() const { return *parts_->master.process; }
const NetemProcess& Rig::netem() const { return *parts_->netem; }
const SlaveProcess& Rig::slave() const { return *parts_->slave; }
const CutaneousProcess& Rig::cutaneous() const { return *parts_->cutaneous; }
const VisualProcess& Rig::visual() const { return *parts_->visual; }
const RecordingDisplay& Rig::display() const { return parts_->display.frames; }

void Rig::idle(Duration limit) {
    const SessionTime end = now() + limit;
    while (now() < end && parts_->loop.step()) {
    }
}

void Rig::press_key() { parts_->display.pressed = true; }
const Page& Rig::page() const { return parts_->display.page; }

void Rig::break_handle(const std::string& words) { parts_->breakable.words = words; }

void Rig::restart_master() {
    parts_->master.process = parts_->make_master(instance_of(Role::kMaster) + 100);
    parts_->join_master();
    parts_->loop.thaw(parts_->master_bit);
    parts_->loop.poke(parts_->master_bit);
}

void Rig::freeze(Role role) { parts_->loop.freeze(parts_->bits[static_cast<std::size_t>(role)]); }
void Rig::thaw(Role role) { parts_->loop.thaw(parts_->bits[static_cast<std::size_t>(role)]); }
double Rig::force_at_handle_N() const { return parts_->breakable.commanded_N; }
double Rig::take_largest_at_handle_N() { return std::exchange(parts_->breakable.largest_N, 0); }
double Rig::force_at_finger_N() const { return parts_->actuator.output(now()).force_N; }
void Rig::press_handle_button(bool down) { parts_->breakable.pressed = down; }

Channel& Rig::stop_channel(Role role) {
    const auto port =
        std::find_if(kStopPorts.begin(), kStopPorts.end(), [&](Port one) { return owner(one) == role; });
    return parts_->stop[static_cast<std::size_t>(port - kStopPorts.begin())].a;
}

FlowCounters Rig::counters() const {
    FlowCounters sum;
    for (const NodeProcess* node :
         std::initializer_list<const NodeProcess*>{&master(), &netem(), &slave(), &cutaneous(), &visual()}) {
        sum.add(node->counters());
    }
    return sum;
}

}  // namespace thimble::test
