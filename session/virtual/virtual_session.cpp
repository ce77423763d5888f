#include "session/virtual/virtual_session.hpp"

#include <stdexcept>
#include <utility>

#include "common/random.hpp"

namespace thimble {
namespace {

template <class Device, class Simulated>
Device& given_or(Device* given, Simulated& simulated) {
    return given != nullptr ? *given : static_cast<Device&>(simulated);
}

}  // namespace

VirtualSession::VirtualSession(const SystemSettings& s, const std::shared_ptr<const LabKey>& lab,
                               const VirtualDevices& devices, QueueNetwork::MakeTap make_tap)
    : settings_(s),
      network_(lab, std::move(make_tap)),
      handle_(s.handle, s.person),
      actuator_(s.cutaneous),
      display_(s.visual.pipeline),
      devices_(devices),
      session_(granted_instance(Role::kSession), session_settings(s), network_.of(Role::kSession)),
      netem_(granted_instance(Role::kNetem), s.netem, network_.of(Role::kNetem)),
      slave_(granted_instance(Role::kSlaveSim), s.slave, network_.of(Role::kSlaveSim)),
      cutaneous_(granted_instance(Role::kCutaneous), s.cutaneous, network_.of(Role::kCutaneous),
                 given_or(devices.actuator, actuator_)),
      visual_(granted_instance(Role::kVisual), s.visual, network_.of(Role::kVisual),
              given_or(devices.display, display_)),
      master_(make_master(granted_instance(Role::kMaster))) {
    add(session_, Role::kSession);
    for (const Role role : {Role::kMaster, Role::kNetem, Role::kSlaveSim, Role::kCutaneous, Role::kVisual}) {
        add(node(role), role);
    }
}

std::unique_ptr<MasterProcess> VirtualSession::make_master(std::uint64_t instance) {
    return std::make_unique<MasterProcess>(instance, settings_.master, network_.of(Role::kMaster),
                                           given_or(devices_.handle, handle_),
                                           given_or(devices_.person, handle_), devices_.follower);
}

void VirtualSession::add(Process& process, Role role) {
    Security* const security = network_.security(role);
    Process* added = &process;
    if (security != nullptr)
        added = secured_.emplace_back(std::make_unique<SecuredProcess>(process, *security)).get();
    bits_[static_cast<std::size_t>(role)] = loop_.add(*added);
    network_.wake(role, loop_.wake_mask(), bit(role));
}

NodeProcess& VirtualSession::node(Role role) {
    for (NodeProcess* one :
         std::initializer_list<NodeProcess*>{&netem_, &slave_, &cutaneous_, &visual_, master_.get()}) {
        if (one->role() == role) return *one;
    }
    throw std::out_of_range("no node has this role");
}

void VirtualSession::start(const TrialConditions& conditions) {
    const Security* const security = network_.security(Role::kSession);
    for (int i = 0; security != nullptr && !security->complete(); ++i) {
        if (i > kMostInstantsForKeys) throw std::logic_error("the nodes do not get their keys");
        loop_.step();
    }
    session_.start(conditions);
    loop_.poke(bit(Role::kSession));
}

bool VirtualSession::step() { return !session_.finished() && loop_.step(); }

const TrialRecord& VirtualSession::run(const TrialConditions& conditions) {
    start(conditions);
    while (step()) {
    }
    return session_.record();
}

void VirtualSession::idle(Duration limit) {
    const SessionTime end = loop_.now() + limit;
    while (loop_.now() < end && loop_.step()) {
    }
}

void VirtualSession::emergency_stop(Role at, std::string_view words) {
    if (at == Role::kSession) {
        session_.emergency_stop(loop_.now(), words);
    } else {
        node(at).stop_everything(loop_.now(), EndReason::kEmergencyStop, words);
    }
    loop_.poke(bit(at));
}

void VirtualSession::release_stop() {
    session_.release_stop(loop_.now());
    loop_.poke(bit(Role::kSession));
}

void VirtualSession::restart_master() {
    master_ = make_master(granted_instance(Role::kMaster) + 1);
    loop_.replace(bit(Role::kMaster), *master_);
}

TrialRecord run_virtual_trial(const SystemSettings& settings, const TrialConditions& conditions) {
    SystemSettings with_delay = settings;
    set_delay(with_delay.netem.force, with_delay.netem.force_timeline, from_seconds(conditions.delay_s));
    VirtualSession session(with_delay);
    return session.run(conditions);
}

}  // namespace thimble
