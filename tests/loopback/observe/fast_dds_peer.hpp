// Another program's side of ROS 2's topics: Fast DDS, with the code that its own generator makes of common/ros2/ros2.idl.
#pragma once

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <memory>
#include <optional>
#include <ros2PubSubTypes.h>
#include <string>
#include <vector>

#include "tests/loopback/workbench.hpp"

namespace thimble {

namespace dds = eprosima::fastdds::dds;

using HeardPose = geometry_msgs::msg::dds_::PoseStamped_PubSubType;
using HeardWrench = geometry_msgs::msg::dds_::WrenchStamped_PubSubType;
using HeardString = std_msgs::msg::dds_::String_PubSubType;
using HeardTransforms = tf2_msgs::msg::dds_::TFMessage_PubSubType;
using HeardClock = rosgraph_msgs::msg::dds_::Clock_PubSubType;

// One that no other test beside this one has, which its last port guards. Its ports lie above those of PortBlock, and below those that
// Linux gives out by itself.
inline unsigned own_domain() {
    constexpr unsigned kFirst = 88, kDomains = 13;
    static const auto claimed = first_free(kDomains, [](unsigned i) {
        return listen_at(7400 + 250 * (kFirst + i) + 249);  // DDSI-RTPS 2.5, 9.6.2
    });
    return kFirst + claimed.first;
}

enum class Asks { kSensorData, kTransforms, kLatched };

class FastDdsPeer {
  public:
    FastDdsPeer() {
        dds::DomainParticipantQos quality;
        const auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
        udp->interfaceWhiteList.emplace_back("127.0.0.1");
        quality.transport().use_builtin_transports = false;
        quality.transport().user_transports.push_back(udp);
        participant_ =
            dds::DomainParticipantFactory::get_instance()->create_participant(own_domain(), quality);
        subscriber_ = participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
        publisher_ = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
    }
    ~FastDdsPeer() {
        participant_->delete_contained_entities();
        dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
    }
    FastDdsPeer(const FastDdsPeer&) = delete;
    FastDdsPeer& operator=(const FastDdsPeer&) = delete;

    // As `ros2 topic echo` asks for sensor data, or for what is latched; as tf2 asks for transforms.
    template <class Type>
    dds::DataReader* reader(const std::string& topic, Asks asks = Asks::kSensorData) {
        dds::DataReaderQos quality;
        quality.history().depth = 100;
        quality.reliability().kind =
            asks == Asks::kSensorData ? dds::BEST_EFFORT_RELIABILITY_QOS : dds::RELIABLE_RELIABILITY_QOS;
        quality.durability().kind =
            asks == Asks::kLatched ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
        return subscriber_->create_datareader(topic_of<Type>(topic), quality);
    }
    template <class Type>
    dds::DataWriter* writer(const std::string& topic) {
        dds::DataWriterQos quality;
        quality.reliability().kind = dds::BEST_EFFORT_RELIABILITY_QOS;
        return publisher_->create_datawriter(topic_of<Type>(topic), quality);
    }

  private:
    template <class Type>
    dds::Topic* topic_of(const std::string& topic) {
        const dds::TypeSupport type(new Type());
        type.register_type(participant_);
        return participant_->create_topic("rt" + topic, type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
    }

    dds::DomainParticipant* participant_ = nullptr;
    dds::Subscriber* subscriber_ = nullptr;
    dds::Publisher* publisher_ = nullptr;
};

// The next message that waits at the reader.
template <class Type>
std::optional<typename Type::type> take(dds::DataReader* reader) {
    typename Type::type message;
    dds::SampleInfo info;
    while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
        if (info.valid_data) return message;
    }
    return std::nullopt;
}

}  // namespace thimble
