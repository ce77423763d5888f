#include <algorithm>
#include <cmath>
#include <dlfcn.h>
#include <set>

#include "common/control/control_settings.hpp"
#include "common/control/controller_calls.hpp"
#include "common/error.hpp"

namespace thimble {
namespace {

constexpr const char* kSymbol = "thimble_controller_table";
constexpr std::uint32_t kMostKeys = 64;

std::string wrong_key(const thimble_controller_key& key) {
    if (key.name == nullptr || *key.name == '\0') return "a key has no name";
    const bool ordered = key.low <= key.fallback && key.fallback <= key.high;  // false for NaN, too
    if (!ordered || !std::isfinite(key.low) || !std::isfinite(key.high))
        return fmt::format("key {} needs finite numbers, low <= fallback <= high", key.name);
    return key.help == nullptr ? fmt::format("key {} has no help", key.name) : "";
}

std::string wrong_keys(const thimble_controller& table) {
    if (table.key_count > kMostKeys || (table.key_count > 0 && table.keys == nullptr))
        return fmt::format("it claims {} keys; at most {} are allowed", table.key_count, kMostKeys);
    std::set<std::string_view> names;
    for (const thimble_controller_key& key : std::span(table.keys, table.key_count)) {
        if (std::string wrong = wrong_key(key); !wrong.empty()) return wrong;
        if (!names.insert(key.name).second) return fmt::format("key {} appears twice", key.name);
    }
    return {};
}

#ifdef __EMSCRIPTEN__
const thimble_controller* table_of(const std::filesystem::path& file) {
    throw Error(ExitCode::kUsage, "plug-in {}: the page in a browser cannot load plug-ins", file.string());
}
#else
const thimble_controller* table_of(const std::filesystem::path& file) {
    if (file.extension() == ".py") return python_controller(file);
    // dlopen looks in its own folders for a name without a slash.
    void* const library = dlopen(std::filesystem::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) throw Error(ExitCode::kUsage, "plug-in {}: {}", file.string(), dlerror());
    const auto symbol = reinterpret_cast<const thimble_controller* (*)()>(dlsym(library, kSymbol));
    if (symbol == nullptr)
        throw Error(ExitCode::kUsage, "plug-in {}: it does not export {}() (<thimble/controller.h>)",
                    file.string(), kSymbol);
    ControllerCalls calls(file.string(), nullptr);
    return calls(kSymbol, symbol);
}
#endif

}  // namespace

std::string wrong_table(const thimble_controller& t) {
    if (t.abi != THIMBLE_CONTROLLER_ABI)
        return fmt::format(
            "it was built for version {} of the interface, and this program has version {}: "
            "build it again with this program's <thimble/controller.h>",
            t.abi, THIMBLE_CONTROLLER_ABI);
    if (t.name == nullptr || *t.name == '\0') return "it has no name";
    const std::uint32_t known = THIMBLE_BOTH_ENDS | THIMBLE_AT_ONCE | THIMBLE_PASSIVE;
    if ((t.capabilities & ~known) != 0) return "it names capabilities that this program does not know";
    if ((t.capabilities & THIMBLE_BOTH_ENDS) != 0 && (t.capabilities & THIMBLE_AT_ONCE) != 0)
        return "a controller with two ends cannot act at once";
    const bool handle = t.create != nullptr && t.destroy != nullptr && t.start != nullptr &&
                        t.sample != nullptr && t.force != nullptr;
    if (!handle) return "it lacks create, destroy, start, sample or force";
    const bool slave = t.create_slave != nullptr && t.destroy_slave != nullptr && t.start_slave != nullptr &&
                       t.receive_slave != nullptr && t.step_slave != nullptr && t.answer_slave != nullptr;
    if ((t.capabilities & THIMBLE_BOTH_ENDS) != 0 && !slave)
        return "it says THIMBLE_BOTH_ENDS, but lacks a function of the slave's end";
    return wrong_keys(t);
}

PluginSettings load_plugin(const std::filesystem::path& file) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error))
        throw Error(ExitCode::kUsage, "plug-in {}: there is no such file", file.string());
    PluginSettings plugin;
    plugin.file = file.string();
    plugin.table = table_of(file);
    if (plugin.table == nullptr)
        throw Error(ExitCode::kUsage, "plug-in {}: {}() returns no table", file.string(), kSymbol);
    if (const std::string wrong = wrong_table(*plugin.table); !wrong.empty())
        throw Error(ExitCode::kUsage, "plug-in {}: {}", file.string(), wrong);
    const std::span keys(plugin.table->keys, plugin.table->key_count);
    plugin.values.reserve(keys.size());
    std::transform(keys.begin(), keys.end(), std::back_inserter(plugin.values),
                   [](const thimble_controller_key& key) { return key.fallback; });
    return plugin;
}

double plugin_hand_share(const PluginSettings& plugin) {
    if (plugin.table->hand_share == nullptr) return 1;
    thimble_controller_settings settings{};
    settings.value_count = static_cast<std::uint32_t>(plugin.values.size());
    settings.values = plugin.values.data();
    settings.file = plugin.file.c_str();
    ControllerCalls calls(plugin.file, nullptr);
    const double share = calls("hand_share", plugin.table->hand_share, &settings);
    return share >= 0 && share <= 1 ? share : 1;
}

}  // namespace thimble
