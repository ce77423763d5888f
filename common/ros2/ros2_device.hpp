// DDS between a session and one device of ROS 2: topics that the session hears, and one that the device obeys. Two senders of that one
// would fight for the device, so there may be no other.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/ros2/ros2_bus.hpp"

namespace thimble {

class Ros2Device {
  public:
    // `orders`: the topic that the device obeys. Throws Error as Ros2Bus does.
    Ros2Device(const Ros2Settings& settings, const char* orders, const dds_topic_descriptor_t& type);

    // A reader of a topic that the device sends.
    dds_entity_t hears(const char* topic, const dds_topic_descriptor_t& type);

    // Call it before take(). A reader that is full so soon again has met a flood.
    void open(SessionTime now) {
        often_ = now - opened_ < kOften;
        opened_ = now;
    }
    // Calls take(writer, message) for the newest that have come, oldest first. A flood costs no more than what the reader keeps.
    template <class Message, class Take>
    void take(dds_entity_t reader, Take take) {
        std::array<void*, kMostAtOnce> samples{};
        std::array<dds_sample_info_t, kMostAtOnce> infos{};
        const int taken = dds_take(reader, samples.data(), infos.data(), kMostAtOnce, kMostAtOnce);
        if (taken <= 0) return;
        for (std::size_t i = 0; i < static_cast<std::size_t>(taken); ++i) {
            if (infos.at(i).valid_data)
                take(infos.at(i).publication_handle, *static_cast<const Message*>(samples.at(i)));
        }
        dds_return_loan(reader, samples.data(), taken);
        if (often_ && taken == static_cast<int>(kMostAtOnce)) ++floods_;
    }
    void tell(const void* order) { bus_.write(orders_, order); }

    // "domain 0 at 127.0.0.1".
    std::string where() const;
    // Throws Error (usage) where another program sends orders. True once the device has been `heard` for kLooksFor and no such program was
    // found: DDS finds programs one after another. From then on it looks for none, since looking takes time of each order.
    bool found_alone(SessionTime now, bool heard, const char* device);
    // Names the publishers that have a heard topic with another type, for the end of a sentence. Empty: there is none.
    std::string wrong_types() const;
    void describe(nlohmann::ordered_json& report) const;

  private:
    static constexpr std::size_t kMostAtOnce = 5;  // as many as a reader keeps
    static constexpr Duration kOften = std::chrono::milliseconds{2};
    static constexpr Duration kLooksFor = std::chrono::milliseconds{500};

    std::vector<std::string> find_wrong_types() const;

    unsigned domain_ = ros2_domain();
    std::string interface_;
    Ros2Bus bus_;
    const char* orders_topic_;
    dds_entity_t orders_;
    dds_entity_t others_;                                     // a reader of orders: other senders would match
    dds_entity_t publishers_;                                 // DDS's own list
    std::vector<std::pair<std::string, std::string>> heard_;  // topic and type, as DDS names them
    std::optional<SessionTime> heard_since_;                  // without a pause
    SessionTime opened_{};
    bool often_ = false;
    std::uint64_t floods_ = 0;  // takes of a full reader that was taken from a moment ago
};

}  // namespace thimble
