#include "common/ros2/ros2_bus.hpp"

#include <memory>

#include <fmt/format.h>

#include "common/error.hpp"

namespace thimble {
namespace {

using Quality = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

Quality quality_of(Ros2Quality quality) {
    Quality q(dds_create_qos(), dds_delete_qos);
    const bool latched = quality == Ros2Quality::kLatched;
    const bool sensor = quality == Ros2Quality::kSensorData;
    const std::int32_t depth = latched ? 10 : sensor ? 5 : 100;
    // A full writer waits for 0 s.
    dds_qset_reliability(q.get(), sensor ? DDS_RELIABILITY_BEST_EFFORT : DDS_RELIABILITY_RELIABLE, 0);
    dds_qset_durability(q.get(), latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
    dds_qset_history(q.get(), DDS_HISTORY_KEEP_LAST, depth);
    if (latched) {
        dds_qset_durability_service(q.get(), 0, DDS_HISTORY_KEEP_LAST, depth, DDS_LENGTH_UNLIMITED,
                                    DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
    }
    dds_qset_writer_data_lifecycle(q.get(), false);  // as ROS 2
    return q;
}

dds_entity_t made(dds_entity_t entity, const std::string& what) {
    if (entity >= 0) return entity;
    throw Error(ExitCode::kNetwork, "DDS cannot make {}: {}", what, dds_strretcode(entity));
}

}  // namespace

// Linux does not claim multicast for the loopback interface, but has it.
Ros2Bus::Ros2Bus(unsigned domain, const std::string& address)
    : domain_(
          made(dds_create_domain(domain, fmt::format("<General><Interfaces><NetworkInterface address=\"{}\" "
                                                     "multicast=\"true\"/></Interfaces></General>",
                                                     address)
                                             .c_str()),
               fmt::format("a domain at {} (is this an address of this machine?)", address))),
      participant_(dds_create_participant(domain, nullptr, nullptr)) {
    if (participant_ >= 0) return;
    dds_delete(domain_);
    made(participant_, fmt::format("a participant of domain {} at {}", domain, address));
}

Ros2Bus::~Ros2Bus() { dds_delete(domain_); }

dds_entity_t Ros2Bus::topic(const std::string& name, const dds_topic_descriptor_t& type) {
    return made(dds_create_topic(participant_, &type, ("rt" + name).c_str(), nullptr, nullptr),
                "topic " + name);
}

dds_entity_t Ros2Bus::writer(const std::string& name, const dds_topic_descriptor_t& type,
                             Ros2Quality quality) {
    return made(dds_create_writer(participant_, topic(name, type), quality_of(quality).get(), nullptr),
                "a writer of " + name);
}

dds_entity_t Ros2Bus::reader(const std::string& name, const dds_topic_descriptor_t& type,
                             Ros2Quality quality) {
    return made(dds_create_reader(participant_, topic(name, type), quality_of(quality).get(), nullptr),
                "a reader of " + name);
}

}  // namespace thimble
