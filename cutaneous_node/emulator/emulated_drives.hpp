// The drives on one bus as a process, and text commands that cause faults in them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/process.hpp"
#include "cutaneous_node/emulator/drive_emulator.hpp"

namespace thimble {

class EmulatedDrives final : public Process {
  public:
    // `bus` outlives them.
    EmulatedDrives(const std::vector<std::uint8_t>& nodes, const PlantParameters& plant, CanBus& bus);

    // The first call switches them on.
    void tick(SessionTime now) override;
    SessionTime next_wakeup() const override;
    bool stopped() const override { return stopped_; }

    // A command of kFaultWords, at once. The error in the command; empty: done. Before the first tick only what outlasts a reset.
    std::string obey(SessionTime now, std::string_view words);
    // A command for `after` the moment at which a force beyond pretension was first pressed. The error in it; empty: noted.
    std::string obey_when_pressed(std::string words, Duration after);

    const DriveEmulator& drive(std::size_t i) const { return drives_[i]; }
    std::size_t drives() const { return drives_.size(); }
    double force_N(std::size_t finger) const;            // of the three drives from 3 finger on
    double strongest_N() const { return strongest_N_; }  // any finger, ever
    std::uint64_t frames() const { return frames_; }

  private:
    struct Later {
        std::string words;
        Duration after{};
    };
    std::string wrong_in(std::string_view line);
    void obey(SessionTime now, DriveEmulator& drive, std::string_view what,
              const std::vector<std::uint32_t>& numbers);
    DriveEmulator* find(std::string_view node);
    void look_at_force(SessionTime now);

    CanBus* bus_;
    std::vector<DriveEmulator> drives_;
    std::vector<Later> later_;
    SessionTime pressed_since_ = kNever;
    double strongest_N_ = 0;
    std::uint64_t frames_ = 0;
    bool on_ = false, stopped_ = false, off_ = false;
};

inline constexpr const char* kFaultWords =
    "  emcy NODE CODE            the drive reports an error, e.g. emcy 3 0x2310 (over-current)\n"
    "  reboot NODE               its supply fails for a moment\n"
    "  silence NODE              it hangs: receives and sends nothing\n"
    "  no-heartbeat NODE         it stops sending its heartbeat only\n"
    "  no-data NODE              it stops sending its process data only\n"
    "  short-data NODE           its process data are two bytes short\n"
    "  duplicate NODE            a second device has its node id\n"
    "  refuse NODE INDEX [SUB]   SDO abort 'no such object' from now on, e.g. refuse 3 0x6060\n"
    "  cut NODE                  its cable breaks\n"
    "  bus-off                   the controller leaves the bus (error frame; no more traffic)\n"
    "  bus-passive               the controller becomes error-passive (error frame)\n"
    "  quit\n";

}  // namespace thimble
