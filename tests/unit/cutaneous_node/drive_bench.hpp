// The actuator over twelve emulated drives on a queue, in virtual time.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "common/queue_channel.hpp"
#include "cutaneous_node/can/cannelloni.hpp"
#include "cutaneous_node/drive_actuator.hpp"
#include "cutaneous_node/emulator/emulated_drives.hpp"

namespace thimble {

inline DriveSettings drive_settings(const std::string& more = "") {
    const ConfigFile file = ConfigFile::parse("[drives]\nbus = \"can0\"\n" + more, "drives.toml");
    DriveSettings settings = read_drive_settings(file.table("drives"));
    file.finish();
    return settings;
}

// The bus between the actuator, at near_end(), and the drives.
struct DriveQueue {
    DriveQueue() {
        here_.connect(there_);
        there_.connect(here_);
    }
    CanBus& near_end() { return near_; }

    QueueChannel here_{1024}, there_{1024};
    CannelloniBus near_{here_}, far_{there_};
};

template <class Bus = DriveQueue>
class DriveBench : public Bus {
  public:
    explicit DriveBench(const std::string& more = "", const PlantParameters& plant = {})
        : settings(drive_settings(more)),
          drives(settings.master.nodes, plant, Bus::far_),
          actuator(settings, 1.5, Bus::near_end()) {}

    // A millisecond, as the node ticks; the drives answer in the same one.
    void tick() {
        now += std::chrono::milliseconds{1};
        actuator.tick(now);
        drives.tick(now);
        actuator.tick(now);
    }
    void run(Duration time) {
        for (const SessionTime end = now + time; now < end;) tick();
    }
    void stall(Duration time, bool drives_alone) {
        const SessionTime end = now + time;
        for (; drives_alone && now < end; now += std::chrono::milliseconds{1}) actuator.tick(now);
        now = end;
    }
    void drives_alone(Duration time) {
        for (const SessionTime end = now + time; now < end;) drives.tick(now += std::chrono::milliseconds{1});
    }
    bool come_up() {
        while (!actuator.ready() && fault().empty() && now < SessionTime{std::chrono::seconds{10}}) tick();
        return actuator.ready();
    }
    void press(Finger finger, double force_N, Duration time) {
        for (const SessionTime end = now + time; now < end; tick()) actuator.command(now, finger, force_N);
    }
    void order(const std::string& words) { EXPECT_EQ(drives.obey(now, words), ""); }
    std::string fault() const { return std::string(actuator.fault()); }
    double felt_N() { return actuator.output(now).force_N; }

    DriveSettings settings;
    EmulatedDrives drives;
    DriveActuator actuator;
    SessionTime now{};
};

// The same, brought up.
struct ReadyDrives : DriveBench<> {
    explicit ReadyDrives(const std::string& more = "", const PlantParameters& plant = {})
        : DriveBench<>(more, plant) {
        EXPECT_TRUE(come_up()) << fault();
    }
};

}  // namespace thimble
