#include "tests/scenario/rig.hpp"

#include <array>
#include <optional>
#include <utility>

#include "cutaneous_node/can/cannelloni.hpp"
#include "cutaneous_node/drive_actuator.hpp"

namespace thimble::test {
namespace {

// Null: a wire that no test has a name for.
std::optional<Wire> wire_to(Port port) {
    if (port <= Port::kSessionNetem) return Wire::kHeartbeats;
    if (port >= Port::kMasterControl && port <= Port::kNetemControl) return Wire::kOrders;
    constexpr std::array kNamed{std::pair{Port::kSlaveNeedle, Wire::kNeedle},
                                std::pair{Port::kMasterForce, Wire::kForceMaster},
                                std::pair{Port::kCutaneousForce, Wire::kForceCutaneous},
                                std::pair{Port::kVisualForce, Wire::kForceVisual},
                                std::pair{Port::kVisualBeep, Wire::kBeep},
                                std::pair{Port::kSessionRecord, Wire::kRecord},
                                std::pair{Port::kMasterPerceptCutaneous, Wire::kPerceptCutaneous},
                                std::pair{Port::kMasterPerceptVisual, Wire::kPerceptVisual}};
    for (const auto& [to, wire] : kNamed) {
        if (to == port) return wire;
    }
    return std::nullopt;
}

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

    Parts(const SystemSettings& s, const MakeTap& tap);
    VirtualDevices devices();

    SystemSettings settings;
    SimulatedHandle handle;
    BreakableHandle breakable{handle};
    PointerHandle pointer;
    SimulatedActuator actuator;
    std::unique_ptr<Driven> driven;
    ReadDisplay display;
    VirtualSession session;
    Channel* hand;
};

HandleSample BreakableHandle::read(SessionTime now) {
    HandleSample sample = inner_->read(now);
    sample.valid = words.empty();
    return sample;
}

Rig::Parts::Parts(const SystemSettings& s, const MakeTap& tap)
    : settings(s),
      handle(s.handle, s.person),
      pointer(s.handle),
      actuator(s.cutaneous),
      driven(s.cutaneous.device == FingertipDevice::kDrives ? std::make_unique<Driven>(s.cutaneous)
                                                            : nullptr),
      display(s.visual.pipeline),
      session(s, nullptr, devices(),
              [tap](Port to, Channel& end) -> std::unique_ptr<Channel> {
                  const std::optional<Wire> wire = tap ? wire_to(to) : std::nullopt;
                  return wire ? tap(*wire, end) : nullptr;
              }),
      hand(session.network().of(Role::kVisual).outlet(Port::kMasterHand)) {
    if (!driven) return;
    driven->bus.a.wake(session.loop().wake_mask(), session.bit(Role::kCutaneous));
    driven->bus.b.wake(session.loop().wake_mask(), session.loop().add(driven->drives));
}

VirtualDevices Rig::Parts::devices() {
    VirtualDevices mine;
    const bool simulated = settings.handle.kind == HandleKind::kSimulated;
    mine.handle = simulated ? static_cast<HapticDevice*>(&breakable) : &pointer;
    mine.person = simulated ? static_cast<OperatorPort*>(&handle) : &pointer;
    mine.follower = simulated ? nullptr : &pointer;
    mine.actuator = driven ? static_cast<FingertipActuator*>(&driven->actuator) : &actuator;
    mine.display = &display;
    return mine;
}

Rig::Rig(const SystemSettings& settings, const MakeTap& make_tap)
    : parts_(std::make_unique<Parts>(settings, make_tap)) {}
Rig::~Rig() = default;

void Rig::start(const TrialConditions& conditions) { parts_->session.start(conditions); }
bool Rig::step() { return parts_->session.step(); }

const TrialRecord& Rig::finish() {
    while (step()) {
    }
    return session().record();
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

SessionTime Rig::now() const { return parts_->session.loop().now(); }
SessionProcess& Rig::session() { return parts_->session.session(); }
SimulatedHandle& Rig::handle() { return parts_->handle; }
Channel& Rig::hand() { return *parts_->hand; }
const PointerHandle& Rig::pointer() const { return parts_->pointer; }
const EmulatedDrives& Rig::drives() const { return parts_->driven->drives; }
void Rig::order_drives(const std::string& words) { parts_->driven->drives.obey(now(), words); }
const MasterProcess& Rig::master() const { return parts_->session.master(); }
const NetemProcess& Rig::netem() const { return parts_->session.netem(); }
const SlaveProcess& Rig::slave() const { return parts_->session.slave(); }
const CutaneousProcess& Rig::cutaneous() const { return parts_->session.cutaneous(); }
const VisualProcess& Rig::visual() const { return parts_->session.visual(); }
const RecordingDisplay& Rig::display() const { return parts_->display.frames; }

void Rig::idle(Duration limit) { parts_->session.idle(limit); }

void Rig::press_key() { parts_->display.pressed = true; }
const Page& Rig::page() const { return parts_->display.page; }

void Rig::break_handle(const std::string& words) { parts_->breakable.words = words; }

void Rig::restart_master() { parts_->session.restart_master(); }

void Rig::freeze(Role role) { parts_->session.loop().freeze(parts_->session.bit(role)); }
void Rig::thaw(Role role) { parts_->session.loop().thaw(parts_->session.bit(role)); }
double Rig::force_at_handle_N() const { return parts_->breakable.commanded_N; }
double Rig::take_largest_at_handle_N() { return std::exchange(parts_->breakable.largest_N, 0); }
double Rig::force_at_finger_N() const { return parts_->actuator.output(now()).force_N; }
void Rig::press_handle_button(bool down) { parts_->breakable.pressed = down; }

Channel& Rig::stop_channel(Role role) {
    return *parts_->session.network().of(Role::kSession).outlet(stop_port(role));
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
