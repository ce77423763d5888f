// All six processes of a session in one program, joined by queues, driven in virtual time. Bytes go through
// the codec and the LinkModels exactly as they do between real processes.
#pragma once

#include <memory>
#include <string_view>

#include "common/security/security.hpp"
#include "session/run/session_process.hpp"
#include "session/settings/system_settings.hpp"
#include "session/virtual/virtual_loop.hpp"

namespace thimble {

class VirtualSession {
  public:
    // With a lab key, its channels are protected as they are between real processes.
    explicit VirtualSession(const SystemSettings& settings,
                            const std::shared_ptr<const LabKey>& lab = nullptr);
    ~VirtualSession();

    // Runs one trial to its end, over the network of the settings.
    const TrialRecord& run(const TrialConditions& conditions);

    // For tests that look inside while a trial runs.
    void start(const TrialConditions& conditions);
    bool step();  // one instant; false once the trial has ended
    SessionProcess& session();
    const SimulatedHandle& handle() const;
    const VirtualLoop& loop() const;
    SecurityCounters security() const;  // of all six

    // Somebody presses stop at that program, or the session releases all stops: as between real processes, over the stop lines.
    void emergency_stop(Role at, std::string_view words);
    void release_stop();
    // Between trials: lets time pass.
    void idle(Duration limit);
    const NodeProcess& node(Role role) const;  // of kNodeRoles

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

// A fresh session for one trial, so that no trial can depend on another. The delay of the force path is that
// of `conditions`, the rest of the network that of the settings.
TrialRecord run_virtual_trial(const SystemSettings& settings, const TrialConditions& conditions);

}  // namespace thimble
