// The two ends of a controller: HandleEnd in the master, SlaveEnd in slave_sim. They call a table
// (<thimble/controller.h>) and keep what it gives within its limits.
#pragma once

#include <boost/core/noncopyable.hpp>

#include "common/control/control_settings.hpp"
#include "common/control/controller.h"
#include "common/control/controller_calls.hpp"
#include "common/messages.hpp"
#include "common/shared_values.hpp"

namespace thimble {

struct HandleControlScale {
    double position_scale = kPositionScale;  // needle = scale x hand
    double force_scale = 1;
    double force_limit_N = kHandleFullScale_N;
    Duration sample_period = std::chrono::milliseconds{1};
};

// In the hand's frame: what the needle felt, and how old that is.
thimble_feedback feedback_of(const ForceFeedback& feedback, const HandleControlScale& scale, double age_s);

class ControllerEnd : boost::noncopyable {
  public:
    const thimble_controller& table() const { return *table_; }
    bool has(std::uint32_t capability) const { return (table_->capabilities & capability) != 0; }
    ControllerTally tally() const;
    const std::string& file() const { return calls_.file(); }  // of a plug-in, else empty

  protected:
    using Create = void* (*)(const thimble_controller_settings*);
    using Destroy = void (*)(void*);
    // Throws Error (usage) if `create` refuses.
    ControllerEnd(const ControlSettings& settings, const HandleControlScale& scale,
                  Create thimble_controller::*create, Destroy thimble_controller::*destroy);
    ~ControllerEnd() {
        try {
            calls_("destroy", destroy_, self_);
        } catch (const Error&) {  // all else goes on: this plug-in is not called again
        }
    }

    // Calls a function that the table may lack.
    template <class... Takes, class... Gives>
    void call(const char* name, void (*function)(void*, Takes...), Gives... gives) {
        if (function != nullptr) calls_(name, function, self_, gives...);
    }
    double finite_or(double value, double instead);
    WaveBurst sent(const thimble_packet& packet);

    const thimble_controller* table_;
    ControllerCalls calls_;
    Destroy destroy_;
    void* self_ = nullptr;
    ControllerTally tally_;
    Duration sample_period_;
};

class HandleEnd final : public ControllerEnd {
  public:
    HandleEnd(const ControlSettings& settings, const HandleControlScale& scale);

    // network_delay: there and back, of a link that is to be expected.
    void start(Duration network_delay);
    void network_changed(Duration network_delay);
    // Returns the packet that goes to the slave with the sample.
    WaveBurst sample(SessionTime now, double position_hand_m, double velocity_hand_m_per_s,
                     double force_hand_N);
    void receive(const thimble_feedback& feedback);
    void receive(const WaveBurst& packet);
    // For force_N() alone: a controller learns from received forces only.
    void predict(const thimble_feedback& feedback) { newest_ = feedback; }
    void forget();
    // waited: since the newest force came. 0 for what is no number.
    double force_N(Duration waited = {});

  private:
    thimble_feedback newest_{};
    SessionTime first_{}, sampled_{};
    bool sampled_before_ = false;
};

class SlaveEnd final : public ControllerEnd {
  public:
    static constexpr std::uint32_t kMostAtOnce = 64;

    SlaveEnd(const ControlSettings& settings, const HandleControlScale& scale);

    void start();
    // How many samples the needle is to be moved.
    std::uint32_t receive(const NeedleWave& message, bool newer);
    double step_hand_m(const thimble_surroundings& surroundings);
    WaveBurst answer(const thimble_feedback& felt);
    void hold();

  private:
    double position_hand_m_ = 0;
};

}  // namespace thimble
