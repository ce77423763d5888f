// A part of a DDS domain as ROS 2 uses it, by Cyclone DDS: writers and readers by ROS 2's topics, with ROS 2's quality of service.
#pragma once

#include <cstdint>
#include <dds/dds.h>
#include <string>

#include <boost/core/noncopyable.hpp>

#include "common/ros2_settings.hpp"

namespace thimble {

enum class Ros2Quality {
    kSensorData,  // best effort, volatile, keep last 5
    kTransforms,  // reliable, volatile, keep last 100, as tf2 has it: its reader refuses best effort
    kLatched,     // reliable, transient local, keep last 10: who comes late gets them too
};

class Ros2Bus : boost::noncopyable {
  public:
    // On the interface with this address only. Throws Error (network).
    Ros2Bus(unsigned domain, const std::string& address);
    ~Ros2Bus();

    // `topic` as ROS 2 has it, "/thimble/...". Throws Error (network).
    dds_entity_t writer(const std::string& topic, const dds_topic_descriptor_t& type, Ros2Quality quality);
    dds_entity_t reader(const std::string& topic, const dds_topic_descriptor_t& type, Ros2Quality quality);

    // Never waits. A message that cannot be sent at once is counted.
    void write(dds_entity_t writer, const void* sample) {
        if (dds_write(writer, sample) != DDS_RETCODE_OK) ++unsent_;
    }
    std::uint64_t unsent() const { return unsent_; }
    // For readers of DDS itself, such as of who is there.
    dds_entity_t participant() const { return participant_; }

  private:
    dds_entity_t topic(const std::string& name, const dds_topic_descriptor_t& type);

    dds_entity_t domain_ = 0, participant_ = 0;
    std::uint64_t unsent_ = 0;
};

}  // namespace thimble
