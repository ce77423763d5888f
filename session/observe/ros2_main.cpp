// thimble-ros2: a session as ROS 2 topics, by DDS. Looks only.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/network_settings.hpp"
#include "common/ros2/ros2_bus.hpp"
#include "common/ros2/ros2_values.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/version.hpp"
#include "master/devices/ros2_handle.hpp"
#include "session/observe/observed_session.hpp"
#include "session/observe/observers.hpp"
#include "session/observe/ros2_events.hpp"
#include "slave_sim/ros2_needle.hpp"
#include "visual_node/views/monitor_receiver.hpp"

namespace {

using namespace thimble;

constexpr Duration kStatePeriod = std::chrono::milliseconds{250};
constexpr Ros2Topic kState{"/session/state", Ros2Type::kString, {}};

struct Ros2Options {
    ObservedSession session;
    std::string interface = "127.0.0.1", prefix = "/thimble";
    std::optional<int> domain;  // none: of ROS_DOMAIN_ID
    bool no_clock = false;
};

// The writers, and one session's Monitor to all of them.
class Ros2Publisher {
  public:
    Ros2Publisher(Ros2Bus& bus, const Ros2Options& options) : bus_(&bus), prefix_(options.prefix) {
        if (!options.no_clock)
            clock_ = bus.writer("/clock", rosgraph_msgs_msg_dds__Clock__desc, Ros2Quality::kSensorData);
    }

    void say_frames(std::int64_t date_ns) {
        std::array<Ros2Transform, 3> frames{ros2_transform(date_ns, "thimble", kTissueFrame, 0),
                                            ros2_transform(date_ns, "thimble", kHandleFrame, 0),
                                            ros2_transform(date_ns, "thimble", kFingerFrame, 0)};
        say_transforms(tf_static_, frames);
    }
    void say_monitor(std::int64_t date_ns, std::uint32_t trial, const Monitor& m) {
        if (clock_ != 0) say(clock_, Ros2Clock{ros2_time(date_ns)});
        const std::array places{m.position_needle_m, m.position_surface_m};
        for (std::size_t i = 0; i < places.size(); ++i)
            say(places_.at(i), ros2_pose(date_ns, kTissueFrame, places.at(i)));
        // The handle's counts positive outwards.
        const std::array forces{m.force_total_N, m.force_tissue_N, m.force_fixture_N, -m.force_hand_N};
        for (std::size_t i = 0; i < forces.size(); ++i)
            say(forces_.at(i), ros2_wrench(date_ns, kForces.at(i).frame, forces.at(i)));
        std::array<Ros2Transform, 3> frames{
            ros2_transform(date_ns, kTissueFrame, "needle", m.position_needle_m),
            ros2_transform(date_ns, kTissueFrame, "surface", m.position_surface_m),
            ros2_transform(date_ns, kTissueFrame, "fixture", m.position_fixture_m)};
        say_transforms(tf_, std::span(frames).first(m.fixture_present ? 3 : 2));
        for (const std::string& event : news_.events(trial, m)) say(event_, Ros2String{ros2_text(event)});
    }
    void say_state(const std::string& state) {
        if (state == state_said_) return;
        say(state_, Ros2String{ros2_text(state)});
        state_said_ = state;
    }

    // Topics and types, for --help.
    static std::string topics(const std::string& prefix) {
        std::string text;
        const auto add = [&](const std::string& name, const std::string& type, const char* quality) {
            text += fmt::format("  {:<38} {:<32} {}\n", name, type, quality);
        };
        for (const Ros2Topic& t : kPlaces) add(prefix + t.name, ros2_name(t.type), "sensor data");
        for (const Ros2Topic& t : kForces) add(prefix + t.name, ros2_name(t.type), "sensor data");
        for (const Ros2Topic& t : {ros2::kEvent, kState})
            add(prefix + t.name, ros2_name(t.type), "reliable, transient local");
        add("/tf", "tf2_msgs/msg/TFMessage", "reliable");
        add("/tf_static", "tf2_msgs/msg/TFMessage", "reliable, transient local");
        add("/clock", "rosgraph_msgs/msg/Clock", "sensor data");
        return text;
    }

  private:
    static constexpr std::array kPlaces{ros2::kNeedlePlace, ros2::kSurfacePlace};
    static constexpr std::array kForces{ros2::kTotalForce, ros2::kTissueForce, ros2::kFixtureForce,
                                        ros2::kHandForce};

    template <class Message>
    void say(dds_entity_t writer, const Message& message) {
        bus_->write(writer, &message);
    }
    void say_transforms(dds_entity_t writer, std::span<Ros2Transform> frames) {
        const auto count = static_cast<std::uint32_t>(frames.size());
        say(writer, Ros2Transforms{{count, count, frames.data(), false}});
    }
    template <std::size_t kTopics>
    std::array<dds_entity_t, kTopics> writers(const std::array<Ros2Topic, kTopics>& topics,
                                              const dds_topic_descriptor_t& type) {
        std::array<dds_entity_t, kTopics> made{};
        for (std::size_t i = 0; i < kTopics; ++i)
            made.at(i) = bus_->writer(prefix_ + topics.at(i).name, type, Ros2Quality::kSensorData);
        return made;
    }
    dds_entity_t latched(const std::string& topic, const dds_topic_descriptor_t& type) {
        return bus_->writer(topic, type, Ros2Quality::kLatched);
    }

    Ros2Bus* bus_;
    std::string prefix_, state_said_;
    Ros2Events news_;
    dds_entity_t clock_ = 0;
    std::array<dds_entity_t, 2> places_ = writers(kPlaces, geometry_msgs_msg_dds__PoseStamped__desc);
    std::array<dds_entity_t, 4> forces_ = writers(kForces, geometry_msgs_msg_dds__WrenchStamped__desc);
    dds_entity_t tf_ = bus_->writer("/tf", tf2_msgs_msg_dds__TFMessage__desc, Ros2Quality::kTransforms);
    dds_entity_t tf_static_ = latched("/tf_static", tf2_msgs_msg_dds__TFMessage__desc);
    dds_entity_t event_ = latched(prefix_ + ros2::kEvent.name, std_msgs_msg_dds__String__desc);
    dds_entity_t state_ = latched(prefix_ + kState.name, std_msgs_msg_dds__String__desc);
};

// Each Monitor of the session becomes messages, in the loop that drives every node.
class Ros2Observer final : public Process {
  public:
    Ros2Observer(Sockets& sockets, Channel& monitor, Ros2Publisher& out, Duration ahead)
        : sockets_(&sockets), receiver_(monitor), out_(&out), ahead_(ahead) {}

    void tick(SessionTime now) override {
        sockets_->tick(now);
        const std::int64_t date_ns = to_nanoseconds(now + ahead_);
        if (next_state_ == SessionTime{}) out_->say_frames(date_ns);
        receiver_.update(now, [&](SessionTime, std::uint32_t trial, const Monitor& monitor) {
            out_->say_monitor(date_ns, trial, monitor);
        });
        sockets_->tick(now);
        out_->say_state(ros2_state(receiver_.trial(), receiver_.newest(), receiver_.silent(now)));
        next_state_ = now + kStatePeriod;
    }
    SessionTime next_wakeup() const override { return next_state_; }
    bool stopped() const override { return false; }

  private:
    Sockets* sockets_;
    MonitorReceiver receiver_;
    Ros2Publisher* out_;
    Duration ahead_;
    SessionTime next_state_{};
};

// For --help: those of thimble-ros2-master and thimble-ros2-slave.
std::string device_topics() {
    std::string text;
    const auto add = [&](const char* name, Ros2Type type, const char* way) {
        text += fmt::format("  {:<38} {:<32} {}\n", name, ros2_name(type), way);
    };
    add(Ros2Handle::kPositions, Ros2Type::kPoseStamped, "from the handle");
    add(Ros2Handle::kForces, Ros2Type::kWrenchStamped, "to the handle");
    add(Ros2Needle::kPositions, Ros2Type::kPoseStamped, "from the robot");
    add(Ros2Needle::kForces, Ros2Type::kWrenchStamped, "from the robot");
    add(Ros2Needle::kOrders, Ros2Type::kPoseStamped, "to the robot");
    return text;
}

// Parts of letters, digits and _ behind one / each. None begins with a digit.
bool is_topic_prefix(const std::string& text) {
    const std::string letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_";
    bool good = text.starts_with('/') && text.find_first_not_of(letters + "0123456789/") == std::string::npos;
    for (std::size_t at = text.find('/'); at != std::string::npos; at = text.find('/', at + 1))
        good = good && text.find_first_of(letters, at) == at + 1;
    return good;
}

void add_ros2_options(CLI::App& app, Ros2Options& o) {
    o.session.add_options(app);
    app.add_option("--domain", o.domain, "DDS domain; default: ROS_DOMAIN_ID, or 0")
        ->check(CLI::Range(0, 232))
        ->type_name("ID");
    app.add_option("--interface", o.interface, "address of the one network interface that DDS uses")
        ->default_val(o.interface)
        ->type_name("ADDRESS");
    app.add_option("--prefix", o.prefix,
                   "first part of the topic names; two sessions at once also need two domains")
        ->check([](const std::string& text) {
            return is_topic_prefix(text) ? std::string() : "write a ROS 2 name, such as /lab/thimble";
        })
        ->default_val(o.prefix);
    app.add_flag("--no-clock", o.no_clock, "do not publish /clock");
    app.set_version_flag("--version", std::string(kVersion));
    app.footer(fmt::format(
        "Topics, types and their quality of service:\n{}\n"
        "Topics of devices, as sensor data; 'thimble run' starts their programs (docs/ros2.md):\n{}\n"
        "Examples:\n  thimble-ros2 deploy/sessions/delay50.toml      # beside: thimble run ... --monitor\n"
        "  ros2 topic echo /thimble/slave_sim/measured_cf\n\n"
        "Exit codes: 0 ok, 2 usage or configuration, 3 network.",
        Ros2Publisher::topics("/thimble"), device_topics()));
}

int observe(const Ros2Options& options) {
    const NetworkSettings network = options.session.network();
    require_observer_here(network.security, options.interface, "--interface");
    const unsigned domain = options.domain ? static_cast<unsigned>(*options.domain) : ros2_domain();
    install_stop_signals();
    Sockets sockets(network);
    Channel& monitor = options.session.monitor(sockets);
    Ros2Bus bus(domain, options.interface);
    Ros2Publisher out(bus, options);
    const ClockPair clocks = read_clock_pair();
    Ros2Observer process(sockets, monitor, out, Duration{clocks.realtime_ns - to_nanoseconds(clocks.before)});
    RealtimeLoop loop(std::span<Listener* const>(sockets.listeners()));
    spdlog::info("ready: ROS 2 topics {}/... in domain {} at {}", options.prefix, domain, options.interface);
    loop.run(process);
    if (bus.unsent() > 0) spdlog::warn("{} messages were not sent, because DDS was full", bus.unsent());
    return static_cast<int>(ExitCode::kOk);
}

}  // namespace

int main(int argc, char** argv) {
    return guarded_main("thimble-ros2", [&] {
        CLI::App app(
            "Publishes a session as ROS 2 topics over DDS: needle, forces, frames, events. It needs no ROS "
            "installation. It only observes: topics cannot change the session.",
            "thimble-ros2");
        Ros2Options options;
        add_ros2_options(app, options);
        if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
        return observe(options);
    });
}
