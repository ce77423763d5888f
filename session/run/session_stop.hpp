// A stop of a session, as its program sees it: it hears the stop key, keeps the stop in a file, and says how to release it.
#pragma once

#include <string>

#include "session/run/condition_plan.hpp"
#include "session/run/stop_file.hpp"

namespace thimble {

class SessionStop {
  public:
    // Both outlive this.
    SessionStop(SessionProcess& session, const ConditionPlan& plan);

    // Throws Error (run failed) if a stop of an earlier session holds.
    void require_released() const { file_.require_released(); }
    // Hears the stop key. Afterwards the file says what the stop bus holds.
    void look();
    bool stopped() const { return session_.stop_bus().stopped(); }
    // Of a stop: its source, its reason and how to release it. Empty: no stop holds.
    std::string words() const;
    std::string how_to_release() const;

  private:
    void hear_key();
    void keep();
    std::string who() const;

    SessionProcess& session_;
    const ConditionPlan& plan_;
    StopFile file_;
    unsigned heard_;     // of emergency_stops()
    bool kept_ = false;  // in the file
    std::string fault_;  // why it could not be kept; empty: it could
};

}  // namespace thimble
