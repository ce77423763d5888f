// thimble-master: the handle with the operator's hand on it.
#include <memory>

#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/node_report.hpp"
#include "common/runtime/protection.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "common/runtime/wall_clock.hpp"
#ifdef THIMBLE_DEVICES
#include "master/devices/falcon/falcon_guardian.hpp"
#endif
#include "master/devices/handle.hpp"
#ifdef THIMBLE_ROS2_HANDLE
#include "master/devices/ros2_handle.hpp"
#endif
#include "master/master_process.hpp"

namespace {

using namespace thimble;

void await_handle(Handle& handle, HandleKind kind, Duration limit) {
    await_user([&handle] { return handle.awaits(); }, limit,
               kind == HandleKind::kFalcon ? "[handle.falcon] homing_limit_s" : "");
    if (!handle.fault().empty()) throw Error(ExitCode::kRunFailed, std::string(handle.fault()));
}

// A real handle has limits of its own where the file has none.
MasterSettings read_master(const ConfigFile& file, HandleKind kind) {
    MasterSettings settings =
        read_master_settings(file, is_real(kind) ? guard_of_real_handle() : GuardSettings{});
    settings.control.clock = wall_now;
    return settings;
}

HandleSettings read_handle(const ConfigFile& file, bool pointer) {
    return read_handle_settings(file.table("handle"),
                                pointer ? std::optional(HandleKind::kPointer) : std::nullopt);
}

#ifdef THIMBLE_ROS2_HANDLE
constexpr const char* kName = "thimble-ros2-master";
// DDS does not protect positions from another machine.
std::shared_ptr<Handle> make_handle(const ConfigFile& file, const HandleSettings& settings) {
    if (settings.kind != HandleKind::kRos2)
        throw Error(ExitCode::kUsage, "{} works with [handle] device = \"ros2\" only: use thimble-master",
                    kName);
    const auto ros2 = read_ros2_settings(file.table("handle").table("ros2"));
    require_protection_of_dds(read_security_settings(file), "handle.ros2", ros2.interface);
    return std::make_shared<Ros2Handle>(ros2, settings.force_limit_N);
}
#else
constexpr const char* kName = "thimble-master";
std::shared_ptr<Handle> make_handle(const ConfigFile& file, const HandleSettings& settings) {
    return open_handle(settings, read_operator_parameters(file.table("operator")),
                       read_runtime_settings(file));
}
#endif

class Master final : public NodeInstance {
  public:
    Master(const ConfigFile& file, Sockets& sockets, std::uint64_t instance, const HandleSettings& settings)
        : kind_(settings.kind),
          user_limit_(user_limit(settings)),
          handle_(make_handle(file, settings)),
          settings_(read_master(file, settings.kind)),
          process_(instance, settings_, sockets, *handle_, *handle_, handle_->follower()) {
        if (handle_->name().empty()) return;
        spdlog::info("handle: {}", handle_->name());
        const GuardSettings& guard = settings_.guard;  // 0: no such limit
        spdlog::info("[guard] force_limit_N = {:g}, force_rate_limit_N_per_s = {:g}, energy_limit_J = {:g}",
                     guard.force_limit_N, guard.force_rate_limit_N_per_s, guard.energy_limit_J);
    }

    NodeProcess& process() override { return process_; }
    void bring_up() override { await_handle(*handle_, kind_, user_limit_); }
    // While the plug-in holds the master's thread, no other thread uses the handle.
    std::function<void()> rest_without_plugin() override {
        return [this] {
            handle_->command_force(wall_now(), 0);
            handle_->enable_force(wall_now(), false);
        };
    }
    void describe(nlohmann::ordered_json& report) const override {
        report["samples"] = process_.samples();
        report["samples_skipped"] = process_.samples_skipped();
        describe_stale(report, settings_.stale, process_.stale_record());
        report["guard"] = {{"tripped", process_.guard().tripped()},
                           {"words", process_.guard().text()},
                           {"cut", process_.guard().cut()},
                           {"most_given_out_J", process_.guard().most_given_out_J()}};
        if (process_.plugin() != nullptr) describe_plugin(report, *process_.plugin());
        report["round_trip"] = quantiles(process_.round_trip().age());  // of the last trial, as the next
        report["hold"] = quantiles(process_.round_trip().hold());
        handle_->describe(report);
    }

  private:
    HandleKind kind_;
    Duration user_limit_;
    std::shared_ptr<Handle> handle_;
    MasterSettings settings_;
    MasterProcess process_;
};

}  // namespace

int main(int argc, char** argv) {
#ifdef THIMBLE_DEVICES
    if (const auto guarded = run_falcon_guardian(argc, argv)) return *guarded;
#endif
    bool pointer = false;
    NodeProgram program;
    program.name = kName;
    program.description =
        "Reads the handle 1000 times a second, sends the needle command to thimble-slave-sim through "
        "thimble-netem, and puts the returned force on the handle. A virtual operator, a person's mouse, "
        "SpaceMouse or gamepad, or a force-feedback device moves the handle (docs/handles.md).";
    program.example = std::string(kName) + " deploy/sessions/delay50.toml";
    program.tables = {"network", "runtime", "master", "guard", "handle", "operator", "control", "codec"};
    program.add_options = [&pointer](CLI::App& app) {
        add_flag(app, "--pointer", pointer,
                 "let a person's mouse move the handle, instead of [handle] device");
    };
    program.read = [&pointer](const ConfigFile& file) {
        const HandleKind kind = read_handle(file, pointer).kind;
        read_operator_parameters(file.table("operator"));
        read_master(file, kind);
    };
    program.build = [&pointer](const ConfigFile& file, Sockets& sockets, std::uint64_t instance) {
        const HandleSettings settings = read_handle(file, pointer);
        if (is_real(settings.kind)) require_protection_of_handle(sockets.settings());
        // Its guardian is waited for, and that wait hears a signal.
        if (settings.kind == HandleKind::kFalcon) install_stop_signals(QuitSignal::kStopsEverything);
        return std::make_unique<Master>(file, sockets, instance, settings);
    };
    return run_node_program(program, argc, argv);
}
