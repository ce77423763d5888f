// The master's side of one drive: boot-up, configuration by SDO, enabling, and then a target out and a measurement in with
// every SYNC. Logic only: `now` and the bus are arguments, everything has a time limit.
#pragma once

#include <optional>
#include <vector>

#include "cutaneous_node/can/can_bus.hpp"
#include "cutaneous_node/can/canopen.hpp"
#include "cutaneous_node/can/cia402.hpp"
#include "cutaneous_node/can/drive_fault.hpp"

namespace thimble {

struct DriveFeedback {
    std::uint16_t statusword = 0;
    std::int32_t position_counts = 0;
    std::int16_t torque_per_mille = 0;
    SessionTime sample_time{};  // of the SYNC it answers
};

class DriveLink {
  public:
    // `settings` outlives the link.
    DriveLink(const CanMasterSettings& settings, std::size_t index);

    void begin(SessionTime now, CanBus& bus);
    void on_frame(SessionTime now, const CanFrame& frame, CanBus& bus);
    // Checks time limits and repeats requests.
    void tick(SessionTime now, CanBus& bus);
    // Right before a SYNC. `slack`: no voltage, no torque.
    void send_target(CanBus& bus, bool slack);
    void on_sync(SessionTime now);

    // Per mille, or counts in synchronous position; position until operation follows the drive.
    void set_target(std::int32_t target) { target_ = target; }
    bool operating() const { return stage_ == Stage::kOperate; }
    bool exchanges() const { return stage_ == Stage::kEnable || stage_ == Stage::kOperate; }
    bool awaits_answer() const { return exchanges() && !answered_; }
    const DriveFeedback& feedback() const { return feedback_; }
    // The SYNC before the newest one has no answer yet.
    bool unanswered() const { return unanswered_; }
    std::uint32_t rated_torque() const { return rated_torque_; }  // 0x6076, in the drive's unit
    const std::optional<DriveFault>& fault() const { return fault_; }

  private:
    enum class Stage { kBoot, kSettle, kConfigure, kStart, kEnable, kOperate };
    enum class Check { kNone, kDeviceType, kModes, kRatedTorque, kMode };
    struct Step {
        const char* name = "";
        Sdo sdo{};
        Check check = Check::kNone;
        bool optional = false;  // a drive without this object goes on without it
    };

    void plan();
    void plan_mapping();
    void plan_cycle();
    void write(const char* name, ObjectKey key, std::uint32_t value, std::uint8_t bytes);
    void enter(SessionTime now, Stage stage);
    void ask(SessionTime now, CanBus& bus);
    void on_reply(SessionTime now, const CanFrame& frame, CanBus& bus);
    bool accepted(const Step& step, const Sdo& reply);
    bool checked(const Step& step, std::uint32_t value);
    void on_heartbeat(SessionTime now, const CanFrame& frame);
    void on_data(SessionTime now, const CanFrame& frame);
    void on_emergency(const CanFrame& frame);
    void check_silence(SessionTime now);
    void fail(DriveFaultKind kind, std::uint32_t code = 0, const char* step = "");

    const CanMasterSettings* settings_;
    std::size_t index_;
    std::uint8_t node_;
    std::vector<Step> steps_;
    std::size_t step_ = 0;
    Stage stage_ = Stage::kBoot;
    SessionTime since_{}, asked_{}, heartbeat_{}, data_{}, sync_{};
    int boot_ups_ = 0, resets_ = 0;
    std::uint64_t data_order_ = 0;  // of the newest measurement
    std::int64_t owed_ = 0;         // SYNCs without an answer, counted up to 128, or to what is silence
    bool answered_ = false;         // since the last one
    bool unanswered_ = false;
    std::uint16_t control_ = kControlDisableVoltage;
    std::int32_t target_ = 0;
    std::uint32_t rated_torque_ = 0;
    DriveFeedback feedback_;
    std::optional<DriveFault> fault_;
};

}  // namespace thimble
