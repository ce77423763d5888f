// One condition of a run in virtual time. A plug-in is called in this program, which a call that does not come back would keep for
// ever. So each call has as long as in lock-step, and create() ten times as long, because it may load something.
#pragma once

#include <memory>
#include <optional>

#include "common/runtime/plugin_watch.hpp"
#include "session/run/condition_plan.hpp"
#include "session/settings/system_settings.hpp"
#include "session/virtual/stepped_condition.hpp"
#include "session/virtual/virtual_session.hpp"

namespace thimble {

// Runs the trials of the plan. The program ends with kPluginHung, and names the plug-in, if one does not come back. Throws Error as
// run_stepped_condition().
inline ConditionResult run_virtual_condition(const ConditionPlan& plan, const ConditionEvents& events,
                                             const SystemSettings& settings) {
    std::optional<PluginWatch> watch;
    if (settings.master.control.compensator == Compensator::kPlugin) watch.emplace();
    return run_stepped_condition(plan, events, [&] {
        if (watch) watch->expect(10 * kPluginLimitInLockStep);
        auto session = std::make_unique<VirtualSession>(settings);
        if (watch) watch->expect(kPluginLimitInLockStep);
        return session;
    });
}

}  // namespace thimble
