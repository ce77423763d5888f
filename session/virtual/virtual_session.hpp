// All six processes of a session in one program, joined by queues, driven in virtual time. Messages go through the LinkModels exactly
// as they do between real processes. They go as structs, and as bytes to a tap or with a lab key (common/shared_message.hpp).
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/security/security.hpp"
#include "cutaneous_node/cutaneous_process.hpp"
#include "cutaneous_node/simulated_actuator.hpp"
#include "master/master_process.hpp"
#include "netem/netem_process.hpp"
#include "session/run/session_process.hpp"
#include "session/settings/system_settings.hpp"
#include "session/virtual/queue_network.hpp"
#include "session/virtual/stepped_condition.hpp"
#include "session/virtual/virtual_loop.hpp"
#include "slave_sim/slave_process.hpp"
#include "visual_node/recording_display.hpp"
#include "visual_node/visual_process.hpp"

namespace thimble {

// Devices of the nodes, which outlive the session. Null: the simulated one of the settings.
struct VirtualDevices {
    HapticDevice* handle = nullptr;
    OperatorPort* person = nullptr;  // goes with `handle`
    HandFollower* follower = nullptr;
    FingertipActuator* actuator = nullptr;
    Display* display = nullptr;
};

class VirtualSession final : public SteppedSession {
  public:
    // With a lab key, its channels are protected as they are between real processes.
    explicit VirtualSession(const SystemSettings& settings,
                            const std::shared_ptr<const LabKey>& lab = nullptr,
                            const VirtualDevices& devices = {}, QueueNetwork::MakeTap make_tap = {});

    // Runs one trial to its end, over the network of the settings.
    const TrialRecord& run(const TrialConditions& conditions);

    // For tests that look inside while a trial runs.
    void start(const TrialConditions& conditions) override;
    bool step() override;
    SessionTime now() const override { return loop_.now(); }
    const std::optional<LostNode>& lost() const override { return lost_; }  // none ever is
    // Between trials: lets time pass.
    void idle(Duration limit);

    SessionProcess& session() override { return session_; }
    const SimulatedHandle& handle() const { return handle_; }
    const SimulatedActuator& actuator() const { return actuator_; }
    const MasterProcess& master() const { return *master_; }
    const NetemProcess& netem() const { return *netem_; }
    const SlaveProcess& slave() const { return *slave_; }
    const CutaneousProcess& cutaneous() const { return *cutaneous_; }
    const VisualProcess& visual() const { return *visual_; }
    NodeProcess& node(Role role);  // of kNodeRoles
    QueueNetwork& network() { return network_; }
    VirtualLoop& loop() { return loop_; }
    const VirtualLoop& loop() const { return loop_; }
    std::uint32_t bit(Role role) const { return bits_.at(static_cast<std::size_t>(role)); }  // in the loop

    // A stop at that program, and the session's release of all stops. Both go over the stop buses, as between real processes.
    void emergency_stop(Role at, std::string_view words);
    void release_stop();
    // Replaces a node by a new instance, as after a crash and a new start. Without a lab key only.
    void restart(Role role);

  private:
    void add(Process& process, Role role);
    void make(Role role, std::uint64_t instance);

    SystemSettings settings_;
    QueueNetwork network_;
    SimulatedHandle handle_;
    SimulatedActuator actuator_;
    RecordingDisplay display_;
    VirtualDevices devices_;
    SessionProcess session_;
    std::unique_ptr<NetemProcess> netem_;
    std::unique_ptr<SlaveProcess> slave_;
    std::unique_ptr<CutaneousProcess> cutaneous_;
    std::unique_ptr<VisualProcess> visual_;
    std::unique_ptr<MasterProcess> master_;
    std::vector<std::unique_ptr<SecuredProcess>> secured_;
    VirtualLoop loop_;
    std::array<std::uint32_t, kRoleCount> bits_{};  // by Role
    std::uint64_t restarts_ = 0;
    std::optional<LostNode> lost_;
};

// Each value that a plug-in gave and that had to be replaced, in words; empty: none. For the log.
std::string plugin_text(const VirtualSession& session);

// A fresh session for one trial, so that no trial can depend on another. The delay of the force path is that
// of `conditions`, the rest of the network that of the settings. With a plug-in the trial runs in a copy of the process: one that
// crashes or hangs gives a record that ends with kDeviceFault and says why.
TrialRecord run_virtual_trial(const SystemSettings& settings, const TrialConditions& conditions);

}  // namespace thimble
