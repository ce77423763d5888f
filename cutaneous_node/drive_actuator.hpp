// Fingertip devices with motor drives on a CAN bus: a force becomes three cable tensions, these become torques (or, through the
// pad's model, positions), and what the drives measure becomes the force that the skin gets.
#pragma once

#include <string>
#include <vector>

#include "cutaneous_node/can/canopen_master.hpp"
#include "cutaneous_node/drive_settings.hpp"
#include "cutaneous_node/fingertip/cable_command.hpp"

namespace thimble {

class DriveActuator final : public FingertipActuator {
  public:
    // `bus` outlives the actuator. force_limit_N: of one finger.
    DriveActuator(const DriveSettings& settings, double force_limit_N, CanBus& bus);

    void command(SessionTime now, Finger finger, double force_N) override;
    // Measured force of the finger with the larger one, N, without pretension.
    FingertipForce output(SessionTime now) override;
    // Back to pretension. No tension at all only after a fault, and after stop().
    void release(SessionTime now) override;
    void use_hand(SessionTime now, Hand hand) override;

    void tick(SessionTime now) override;
    SessionTime next_wakeup() const override { return master_.next_wakeup(); }
    std::string_view fault() const override { return fault_; }
    // Every drive in operation, every cable taut.
    bool ready() const { return taut_ && master_.operating(); }
    void stop() { master_.stop(); }

    const CanopenMaster& master() const { return master_; }
    // Along the pad's normal, pretension included.
    double measured_N(std::size_t finger) const;

  private:
    struct Cable {
        std::int32_t origin = 0;  // counts when it was taut
        double drawn_m = 0;       // of take-up by position
        double before_m = 0;      // of take-up by torque: where it stood at the last look
        bool taut = false;
        SlackDetector slack;
        SessionTime measured{};  // the last sample that the detector has seen
    };

    void take_up(SessionTime now);
    bool look_for_rest(SessionTime now);
    void draw_in(double step_s);
    void set_targets();
    void set_tension(std::size_t drive, double tension_N);
    void watch_slack(SessionTime now);
    double tension_N(std::size_t drive) const;
    double wound_m(std::size_t drive) const;
    double rated_torque_Nm(std::size_t drive) const;
    // How far a cable under this tension is drawn in beyond where it stood under pretension, to which the pad had yielded. `share` of
    // the elastic force that resists what is beyond pretension: 1 at first, relaxed_share_ once the pad has yielded to this too.
    double drawn_in_m(double tension_N, double share) const;
    void fail(SessionTime now, DriveFaultKind kind, std::size_t drive);
    void note_fault();

    DriveSettings settings_;
    ForceShape shape_;
    FingerGeometry geometry_;
    PadModel pad_;
    CanopenMaster master_;
    std::vector<Cable> cables_;
    Hand hand_ = Hand::kActing;
    Finger finger_ = Finger::kNone;
    double force_N_ = 0;
    double relaxed_share_ = 1;  // of the pad's elastic force that stays
    double resting_m_ = 0;      // how far the pretension presses the pad in
    bool taut_ = false, taking_up_ = false;
    SessionTime taking_up_since_{}, next_look_{}, before_{};
    std::string fault_;
};

}  // namespace thimble
