#include "session/virtual/virtual_session.hpp"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/process/isolated.hpp"
#include "common/random.hpp"

namespace thimble {
namespace {

template <class Device, class Simulated>
Device& given_or(Device* given, Simulated& simulated) {
    return given != nullptr ? *given : static_cast<Device&>(simulated);
}

// All that a trial of virtual time records. Only the settings change the network. The plug-in's values that are no numbers come last,
// as words: the log of a copy is lost.
std::string bytes_of_trial(const SystemSettings& settings, const TrialConditions& conditions) {
    VirtualSession session(settings);
    const TrialRecord& record = session.run(conditions);
    std::string bytes = bytes_of(record.beep_time_s) + bytes_of(record.round_trip_s) +
                        bytes_of(record.achieved_delay_s) + bytes_of(record.reason) +
                        bytes_of(record.lost_peer) + bytes_of(record.fault.size()) + record.fault +
                        bytes_of(record.samples.size());
    for (const TrajectorySample& sample : record.samples) bytes += bytes_of(sample);
    return bytes + plugin_text(session);
}

TrialRecord run_plugin_trial(const SystemSettings& settings, const TrialConditions& conditions) {
    TrialRecord record;
    record.conditions = conditions;
    record.conditions.compensator = Compensator::kPlugin;
    const IsolatedResult apart = run_isolated([&] { return bytes_of_trial(settings, conditions); });
    if (!apart.bytes) {
        record.reason = EndReason::kDeviceFault;
        record.lost_peer = Role::kMaster;
        record.fault = apart.failure;
        spdlog::error("trial {}: {}", conditions.trial, apart.failure);
        return record;
    }
    std::string_view bytes = *apart.bytes;
    record.beep_time_s = take_plain<double>(bytes);
    record.round_trip_s = take_plain<double>(bytes);
    record.achieved_delay_s = take_plain<double>(bytes);
    record.reason = take_plain<EndReason>(bytes);
    record.lost_peer = take_plain<Role>(bytes);
    const auto fault_size = take_plain<std::size_t>(bytes);
    record.fault = bytes.substr(0, fault_size);
    bytes.remove_prefix(fault_size);
    record.samples.resize(take_plain<std::size_t>(bytes));
    for (TrajectorySample& sample : record.samples) sample = take_plain<TrajectorySample>(bytes);
    if (!bytes.empty()) spdlog::warn("trial {}: {}", conditions.trial, bytes);
    return record;
}

}  // namespace

VirtualSession::VirtualSession(const SystemSettings& s, const std::shared_ptr<const LabKey>& lab,
                               const VirtualDevices& devices, QueueNetwork::MakeTap make_tap)
    : settings_(s),
      network_(lab, std::move(make_tap)),
      handle_(s.handle, s.person),
      actuator_(s.cutaneous),
      display_(s.visual),
      devices_(devices),
      session_(granted_instance(Role::kSession), session_settings(s), network_.of(Role::kSession)) {
    for (const Role role : kNodeRoles) make(role, granted_instance(role));
    add(session_, Role::kSession);
    for (const Role role : kTickOrder) add(node(role), role);
}

void VirtualSession::make(Role role, std::uint64_t instance) {
    Ports& ports = network_.of(role);
    if (role == Role::kMaster)
        master_ = std::make_unique<MasterProcess>(instance, settings_.master, ports,
                                                  given_or(devices_.handle, handle_),
                                                  given_or(devices_.person, handle_), devices_.follower);
    if (role == Role::kNetem) netem_ = std::make_unique<NetemProcess>(instance, settings_.netem, ports);
    if (role == Role::kSlaveSim) slave_ = std::make_unique<SlaveProcess>(instance, settings_.slave, ports);
    if (role == Role::kCutaneous)
        cutaneous_ = std::make_unique<CutaneousProcess>(instance, settings_.cutaneous, ports,
                                                        given_or(devices_.actuator, actuator_));
    if (role == Role::kVisual)
        visual_ = std::make_unique<VisualProcess>(instance, settings_.visual, ports,
                                                  given_or(devices_.display, display_));
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
    for (NodeProcess* one : std::initializer_list<NodeProcess*>{netem_.get(), slave_.get(), cutaneous_.get(),
                                                                visual_.get(), master_.get()}) {
        if (one->role() == role) return *one;
    }
    throw std::out_of_range("no node has this role");
}

void VirtualSession::start(const TrialConditions& conditions) {
    const Security* const security = network_.security(Role::kSession);
    for (int i = 0; security != nullptr && !security->complete(); ++i) {
        if (i > kMostInstantsForKeys) throw std::logic_error("cannot give the programs their keys");
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

void VirtualSession::restart(Role role) {
    make(role, granted_instance(role) + ++restarts_);
    loop_.replace(bit(role), node(role));
}

std::string plugin_text(const VirtualSession& session) {
    std::string text;
    for (const ControllerEnd* end :
         std::initializer_list<const ControllerEnd*>{session.master().plugin(), session.slave().plugin()}) {
        if (end == nullptr || end->tally().not_numbers == 0) continue;
        text += fmt::format("{}plug-in {} returned {} values in {} samples that are not numbers",
                            text.empty() ? "" : "; ", end->file(), end->tally().not_numbers,
                            end->tally().samples);
    }
    return text;
}

TrialRecord run_virtual_trial(const SystemSettings& settings, const TrialConditions& conditions) {
    const SystemSettings delayed = with_force_delay(settings, from_seconds(conditions.delay_s));
    if (settings.master.control.compensator == Compensator::kPlugin && conditions.modality == Modality::kHF)
        return run_plugin_trial(delayed, conditions);
    return VirtualSession(delayed).run(conditions);
}

}  // namespace thimble
