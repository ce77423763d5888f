// One motor drive as the bus sees it: CiA 301 node, CiA 402 automaton, motor, cable and pad behind it; and what may go wrong
// with it, on command. Logic only: `now` and the bus are arguments.
#pragma once

#include <optional>

#include "common/time.hpp"
#include "cutaneous_node/can/can_bus.hpp"
#include "cutaneous_node/can/cia402.hpp"
#include "cutaneous_node/emulator/cable_plant.hpp"
#include "cutaneous_node/emulator/object_dictionary.hpp"

namespace thimble {

class DriveEmulator {
  public:
    DriveEmulator(std::uint8_t node, const PlantParameters& plant);

    std::uint8_t node() const { return node_; }
    // Power on, or NMT reset: says that it has booted.
    void reset(SessionTime now, CanBus& bus);
    void on_frame(SessionTime now, const CanFrame& frame, CanBus& bus);
    void tick(SessionTime now, CanBus& bus);
    SessionTime next_wakeup() const;

    const CablePlant& plant() const { return plant_; }
    DriveState state() const { return automaton_.state(); }
    std::uint32_t object(ObjectKey key) const { return dictionary_.get(key); }

    // Faults. They stay until the next reset, except a cut cable.
    void emergency(std::uint16_t code, CanBus& bus);  // and the power stage is off
    void fall_silent() { silent_ = true; }            // hears and says nothing, keeps its torque
    void stop_heartbeat() { heartbeat_off_ = true; }
    void stop_data() { data_off_ = true; }
    void shorten_data() { short_data_ = true; }
    void double_itself() { doubled_ = true; }  // a second device with its node id; outlives resets
    void refuse(ObjectKey key, SdoAbort why);  // outlives resets
    void cut_cable() { plant_.cut(); }

  private:
    void on_network(SessionTime now, const CanFrame& frame, CanBus& bus);
    void on_sdo(SessionTime now, const CanFrame& frame, CanBus& bus);
    void on_target(const CanFrame& frame, CanBus& bus);
    void on_sync(CanBus& bus);
    void obey_objects();
    SessionTime after_heartbeat(SessionTime now) const;
    void advance(SessionTime now);

    struct Refused {
        ObjectKey key;
        SdoAbort why;
    };

    std::uint8_t node_;
    ObjectDictionary dictionary_;
    DriveAutomaton automaton_;
    CablePlant plant_;
    NetworkState network_ = NetworkState::kPreOperational;
    SessionTime plant_time_ = kNever;  // until when the plant has moved; kNever: not switched on yet
    SessionTime next_heartbeat_ = kNever;
    SessionTime master_heard_ = kNever;  // kNever: not yet
    std::optional<CanFrame> target_;     // for the next SYNC
    std::optional<Refused> refused_;
    bool silent_ = false, heartbeat_off_ = false, data_off_ = false, short_data_ = false, doubled_ = false;
};

}  // namespace thimble
