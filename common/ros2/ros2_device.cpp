#include "common/ros2/ros2_device.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"

namespace thimble {
namespace {

// The most publishers that are examined. A domain with more has other problems.
constexpr std::size_t kMostPublishers = 256;

// From DDS's name of a type to that of ROS 2, "geometry_msgs/msg/PoseStamped".
std::string ros2_type(std::string name) {
    constexpr std::string_view kMangled = "::msg::dds_::";
    const std::size_t at = name.find(kMangled);
    if (at == std::string::npos || name.back() != '_') return name;
    name.pop_back();
    return name.replace(at, kMangled.size(), "/msg/");
}

}  // namespace

Ros2Device::Ros2Device(const Ros2Settings& settings, const char* orders, const dds_topic_descriptor_t& type)
    : interface_(settings.interface),
      bus_(domain_, interface_),
      orders_topic_(orders),
      orders_(bus_.writer(orders, type, Ros2Quality::kSensorData)),
      others_(bus_.reader(orders, type, Ros2Quality::kSensorData)),
      publishers_(
          dds_create_reader(bus_.participant(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr)) {}

dds_entity_t Ros2Device::hears(const char* topic, const dds_topic_descriptor_t& type) {
    heard_.emplace_back(std::string("rt") + topic, type.m_typename);
    return bus_.reader(topic, type, Ros2Quality::kSensorData);
}

std::string Ros2Device::where() const { return fmt::format("domain {} at {}", domain_, interface_); }

bool Ros2Device::found_alone(SessionTime now, bool heard, const char* device) {
    if (dds_get_matched_publications(others_, nullptr, 0) > 1)  // orders_ is one
        throw Error(ExitCode::kUsage,
                    "another program sends on {} ({}), so a {} would follow both: end the other session, or "
                    "give each session its own domain with ROS_DOMAIN_ID",
                    orders_topic_, where(), device);
    heard_since_ = heard ? heard_since_.value_or(now) : std::optional<SessionTime>{};
    if (!heard_since_ || now - *heard_since_ < kLooksFor) return false;
    dds_delete(others_);
    return true;
}

std::vector<std::string> Ros2Device::find_wrong_types() const {
    std::vector<void*> samples(kMostPublishers, nullptr);
    std::vector<dds_sample_info_t> infos(kMostPublishers);
    const int found = dds_read(publishers_, samples.data(), infos.data(), kMostPublishers, kMostPublishers);
    std::vector<std::string> wrong;
    for (std::size_t i = 0; found > 0 && i < static_cast<std::size_t>(found); ++i) {
        if (!infos[i].valid_data) continue;
        const auto* endpoint = static_cast<const dds_builtintopic_endpoint_t*>(samples[i]);
        for (const auto& [topic, type] : heard_) {
            if (topic != endpoint->topic_name || type == endpoint->type_name) continue;
            wrong.push_back(fmt::format("{} has type {}, not {}", topic.substr(2),
                                        ros2_type(endpoint->type_name), ros2_type(type)));
        }
    }
    if (found > 0) dds_return_loan(publishers_, samples.data(), found);
    return wrong;
}

std::string Ros2Device::wrong_types() const {
    const auto wrong = find_wrong_types();
    return wrong.empty() ? std::string() : fmt::format("; {}", fmt::join(wrong, "; "));
}

void Ros2Device::describe(nlohmann::ordered_json& report) const {
    report["floods"] = floods_;
    report["wrong_types"] = find_wrong_types();
}

}  // namespace thimble
