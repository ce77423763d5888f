#include "master/devices/haply/haply_message.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "master/devices/device_mailbox.hpp"

namespace thimble {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kLongestId = 64;
constexpr const char* kAxes[] = {"x", "y", "z"};

// Null where there is none.
const Json* member(const Json* value, const char* key) {
    if (value == nullptr || !value->is_object()) return nullptr;
    const auto found = value->find(key);
    return found == value->end() ? nullptr : &*found;
}

std::string text_of_member(const Json& value, const char* key) {
    const Json* found = member(&value, key);
    return found != nullptr && found->is_string() ? found->get<std::string>() : "";
}

bool is_id(const std::string& text) {
    return !text.empty() && text.size() <= kLongestId && std::all_of(text.begin(), text.end(), [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_';
    });
}

const Json* devices_of(const Json& message) {
    const Json* devices = member(&message, "inverse3");
    return devices != nullptr && devices->is_array() ? devices : nullptr;
}

std::optional<DeviceVector> vector_of(const Json* value) {
    DeviceVector vector{};
    for (std::size_t i = 0; i < vector.size(); ++i) {
        const Json* component = member(value, kAxes[i]);
        if (component == nullptr || !component->is_number()) return std::nullopt;
        vector[i] = component->get<double>();
        if (!(std::fabs(vector[i]) < DeviceMailbox::kReach_m)) return std::nullopt;  // also for NaN
    }
    return vector;
}

HaplyReading state_of(const Json& device) {
    const auto position_m = vector_of(member(member(&device, "state"), "cursor_position"));
    if (!position_m) return {{}, "the service sends no cursor_position in metres"};
    const Json* calibrated = member(member(&device, "status"), "calibrated");
    return {HaplyState{*position_m, calibrated == nullptr || *calibrated != false}, ""};
}

}  // namespace

std::vector<std::string> haply_device_ids(std::string_view message) {
    const Json json = Json::parse(message, nullptr, false);
    const Json* devices = devices_of(json);
    std::vector<std::string> ids;
    if (devices == nullptr) return ids;
    ids.reserve(devices->size());
    for (const Json& device : *devices) {
        if (std::string id = text_of_member(device, "device_id"); is_id(id)) ids.push_back(std::move(id));
    }
    return ids;
}

HaplyReading read_haply_state(std::string_view message, std::string_view device_id) {
    const Json json = Json::parse(message, nullptr, false);
    if (json.is_discarded()) return {{}, "the service sends something that is not JSON"};
    const Json* devices = devices_of(json);
    if (devices == nullptr) return {{}, "the service sends no list of its Inverse3"};
    for (const Json& device : *devices) {
        if (text_of_member(device, "device_id") == device_id) return state_of(device);
    }
    return {{}, "the service no longer lists the device: is it plugged in and switched on?"};
}

std::string haply_command(std::string_view device_id, HaplyForceKey key, const DeviceVector& force_N) {
    return fmt::format(
        R"({{"inverse3":[{{"device_id":"{}","commands":{{"set_cursor_force":{{"{}":{{"x":{:.4f},"y":{:.4f},"z":{:.4f}}}}}}}}}]}})",
        device_id, key == HaplyForceKey::kVector ? "vector" : "values", force_N[0], force_N[1], force_N[2]);
}

}  // namespace thimble
