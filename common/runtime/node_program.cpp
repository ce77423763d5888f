#include "common/runtime/node_program.hpp"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <optional>
#include <thread>

#include <CLI/CLI.hpp>
#include <boost/core/noncopyable.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/log/log_settings.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/grant_stream.hpp"
#include "common/runtime/lock_step.hpp"
#include "common/runtime/log/message_log.hpp"
#include "common/runtime/node_report.hpp"
#include "common/runtime/plugin_watch.hpp"
#include "common/runtime/protection.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "common/runtime/service_notice.hpp"
#include "common/runtime/standard_streams.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/text_file.hpp"
#include "common/version.hpp"

namespace thimble {
namespace {

struct Options {
    std::string config, report, log;
    int base_port = 0;
    bool strict_rt = false, lock_step = false;
    pid_t launcher = 0;  // for stop_with_parent(); 0: this program outlives its launcher
};

double microseconds(Duration duration) { return static_cast<double>(duration.count()) * 1e-3; }

void save(const std::string& path, const nlohmann::ordered_json& report) {
    if (path.empty()) return;
    write_text_file(path, json_text(report, 2) + '\n');
}

// Every program reads these.
struct SharedSettings {
    NetworkSettings network{};
    RuntimeSettings runtime{};
    LogSettings logging{};
};

// Own tables are checked here, the others by the programs they belong to.
SharedSettings read_config(const NodeProgram& program, const ConfigFile& file) {
    std::vector<std::string_view> elsewhere;
    for (const std::string_view table : session_tables()) {
        const auto& own = program.tables;
        if (table == "log" || table == "security") continue;  // every program's, read here
        if (std::find(own.begin(), own.end(), table) == own.end()) elsewhere.push_back(table);
    }
    SharedSettings shared;
    file.read_all(
        [&] {
            shared = {read_network_settings(file), read_runtime_settings(file), read_log_settings(file)};
            if (program.read) program.read(file);
        },
        elsewhere);
    return shared;
}

// Empty: nothing is to be written.
std::filesystem::path log_path(const NodeProgram& program, const Options& options,
                               const LogSettings& settings) {
    if (settings.messages == LoggedMessages::kNone) return {};
    if (!options.log.empty() || settings.folder.empty()) return options.log;
    // The name is free: there is one such process at a time.
    return std::filesystem::path(settings.folder) /
           fmt::format("{}_{}.mcap", program.name, read_clock_pair().realtime_ns);
}

LogOrigin log_origin(const NodeProgram& program, const Options& options, const ConfigFile& file) {
    LogOrigin origin{program.name, options.config, {}};
    for (const std::string& name : file.used_files()) origin.files.push_back(file.folder() / name);
    return origin;
}

int check_deadlines(const Options& options, const RuntimeSettings& runtime, const LoopStatistics& loop) {
    const double fraction =
        loop.deadlines == 0 ? 0 : static_cast<double>(loop.missed) / static_cast<double>(loop.deadlines);
    if (!options.strict_rt || fraction <= runtime.allowed_miss_fraction)
        return static_cast<int>(ExitCode::kOk);
    spdlog::error(
        "{} of {} deadlines missed by more than {} ms, worst {:.0f} us; --strict-rt allows a fraction of {}",
        loop.missed, loop.deadlines, kDeadlineSlack.count() / 1'000'000, microseconds(loop.lateness.worst()),
        runtime.allowed_miss_fraction);
    return static_cast<int>(ExitCode::kRealtime);
}

// Passes SIGQUIT and missed deadlines from the loop to the process.
class LoopWatch {
  public:
    LoopWatch(NodeProcess& process, const RuntimeSettings& runtime) : process_(&process) {
        process.set_overrun(runtime.overrun, runtime.overrun_limit);
    }
    void turned(SessionTime now, const LoopStatistics& loop) {
        if (const unsigned asked = emergency_stops(); asked != emergencies_) {
            emergencies_ = asked;
            process_->stop_everything(now, EndReason::kEmergencyStop, "SIGQUIT to a program of the session");
        }
        process_->deadlines_missed(now, loop.missed_in_a_row);
        if (process_->overruns() == 0 || said_) return;
        said_ = true;  // once: a node that is late has no time for more
        spdlog::warn(
            "{} deadlines missed in a row, by more than {} ms each; [runtime] overrun decides the reaction",
            loop.missed_in_a_row, kDeadlineSlack.count() / 1'000'000);
    }

  private:
    NodeProcess* process_;
    unsigned emergencies_ = 0;  // carried out
    bool said_ = false;
};

// Deadlines are kept by the thread that calls this, whichever it is: scheduling belongs to threads.
void run_process(NodeInstance& instance, Process& process, const RuntimeSettings& runtime, RealtimeLoop& loop,
                 ServiceNotice& notice) {
    if (const std::string warning = ask_for_realtime(runtime); !warning.empty()) spdlog::warn(warning);
    notice.ready();
    LoopWatch watch(instance.process(), runtime);
    watch.turned(wall_now(), loop.statistics());  // a stop that came before the loop comes before every order
    loop.run(process, [&](SessionTime now) {
        notice.turns(now);
        watch.turned(now, loop.statistics());
    });
    instance.process().leave(wall_now());  // before log and report, which a slow disk can hold up
    notice.stopping();
}

// Of all calls of a plug-in in this program. Null: it calls none.
std::unique_ptr<PluginWatch> watch_plugin(const NodeProgram& program, const ConfigFile& file) {
    const auto& own = program.tables;
    const bool controls = std::find(own.begin(), own.end(), "control") != own.end();
    return controls && file.table("control").has("plugin") ? std::make_unique<PluginWatch>() : nullptr;
}

// A node whose plug-in is watched from create() to destroy(). `limit`: of a call in a trial. create() has ten times as long, because it
// may load something. That is less than a session waits for its nodes by default.
class WatchedInstance : boost::noncopyable {
  public:
    WatchedInstance(const NodeProgram& program, const ConfigFile& file, Sockets& sockets,
                    std::uint64_t number, Duration limit)
        : watch_(watch_plugin(program, file)) {
        expect(10 * limit);
        instance_ = program.build(file, sockets, number);
        expect(limit, instance_->rest_without_plugin());
    }
    ~WatchedInstance() { expect(kPluginLimitAtEnd, instance_->rest_without_plugin()); }

    NodeInstance& operator*() const { return *instance_; }
    NodeInstance* operator->() const { return instance_.get(); }

  private:
    void expect(Duration limit, std::function<void()> rest = {}) {
        if (watch_ != nullptr) watch_->expect(limit, std::move(rest));
    }

    std::unique_ptr<PluginWatch> watch_;  // outlives the node
    std::unique_ptr<NodeInstance> instance_;
};

// The process in a second thread beside the node's foreground. An error of the foreground is reported after the process has stopped.
void run_beside_foreground(NodeInstance& instance, Process& process, const RuntimeSettings& runtime,
                           RealtimeLoop& loop, ServiceNotice& notice) {
    std::atomic<bool> stopped{false};
    std::exception_ptr died, foreground_died;
    std::thread thread([&] {
        try {
            run_process(instance, process, runtime, loop, notice);
        } catch (...) {
            died = std::current_exception();
        }
        stopped = true;
    });
    try {
        instance.foreground([&stopped] { return stopped.load(); });
    } catch (...) {
        foreground_died = std::current_exception();
    }
    thread.join();
    if (died) std::rethrow_exception(died);
    if (foreground_died) std::rethrow_exception(foreground_died);
}

// A node's process behind its protection. Says once if the session has another lab key.
class Guarded final : public Process {
  public:
    // `log`: in lock-step, where it takes its time from each tick; null: none does.
    Guarded(NodeProcess& node, Security* security, MessageLog* log = nullptr)
        : node_(&node), security_(security), log_(log) {
        if (security_ != nullptr) secured_.emplace(node, *security_);
    }
    void tick(SessionTime now) override {
        if (log_ != nullptr) log_->take_time(now);
        if (!secured_) return node_->tick(now);
        secured_->tick(now);
        if (complained_ || security_->complete()) return;
        const std::string complaint = security_->complaint();
        complained_ = !complaint.empty();
        if (complained_) spdlog::error(complaint);
    }
    SessionTime next_wakeup() const override {
        return secured_ ? secured_->next_wakeup() : node_->next_wakeup();
    }
    bool stopped() const override { return node_->stopped(); }

  private:
    NodeProcess* node_;
    Security* security_;
    MessageLog* log_;
    std::optional<SecuredProcess> secured_;
    bool complained_ = false;
};

// A log of one trial in lock-step, whose clock begins anew with each; null: `file` is empty.
std::unique_ptr<MessageLog> log_of_trial(const std::filesystem::path& file) {
    if (file.empty()) return nullptr;
    remove_file(file);
    auto log = std::make_unique<MessageLog>();
    log->take_time({});
    return log;
}

// For each trial the node is built anew: as good as a program that has just been started. The report is that of the last trial.
class ConductedNode {
  public:
    ConductedNode(const NodeProgram& program, const Options& options, const ConfigFile& file,
                  const SharedSettings& settings)
        : program_(program), options_(options), file_(file), settings_(settings) {}

    // Returns the order that ends the trial; none if the conductor is gone.
    std::optional<LockStepMessage> run_trial(LockStepEnd& conductor, const LockStepMessage& begin) {
        const auto log_file = log_path_of_trial(log_path(program_, options_, settings_.logging), ++trials_);
        const auto log = log_of_trial(log_file);
        Sockets sockets(without_user_key(settings_.network));
        sockets.count_datagrams(Duration{begin.time_ns});
        const bool all = settings_.logging.messages == LoggedMessages::kAll && !program_.relays;
        if (log) sockets.record_to(*log, all);
        const WatchedInstance instance(program_, file_, sockets, begin.instance, kPluginLimitInLockStep);
        if (instance->has_foreground())
            throw Error(ExitCode::kUsage,
                        "a window works in real time only, not in lock-step: set [visual] display = "
                        "\"recording\", or use --clock wall");
        if (log) {
            log->start(log_file, log_origin(program_, options_, file_), settings_.logging);
            instance->process().record_with(*log);
        }
        Guarded process(instance->process(), sockets.security(), log.get());
        const auto order = run_in_lock_step(conductor, process, sockets,
                                            [&] { return instance->process().patient_until(); });
        report_ = describe_program(program_, *instance, sockets, instance->process().counters(),
                                   LoopStatistics{}, instance->process().overruns());
        if (log) {
            note_stale(*log, report_);
            report_["log"] = describe_log(log->close());
            if (log_fault_.empty()) log_fault_ = log->fault();
            report_["log"]["fault"] = log_fault_;  // of any trial
        }
        return order;
    }
    const nlohmann::ordered_json& report() const { return report_; }

  private:
    const NodeProgram& program_;
    const Options& options_;
    const ConfigFile& file_;
    const SharedSettings& settings_;
    unsigned trials_ = 0;
    std::string log_fault_;
    nlohmann::ordered_json report_;
};

// By TCP where the launcher has given a key: this machine is not the conductor's.
std::unique_ptr<LockStepEnd> conductor_of(const NodeProgram& program, const NetworkSettings& network) {
    // NOLINTNEXTLINE(concurrency-mt-unsafe): no thread sets a variable
    const char* const key = std::getenv(kGrantKeyVariable);  // an empty one is wrong
    if (key == nullptr) return std::make_unique<LockStepEnd>(STDIN_FILENO, Duration::zero());
    prepare_security();
    const Endpoint there{network.host(Role::kSession), network.base_port};
    return std::make_unique<LockStepEnd>(GrantStream::to_conductor(there, read_grant_key(key), program.name),
                                         Duration::zero());
}

int run_by_conductor(const NodeProgram& program, const Options& options, const ConfigFile& file,
                     const SharedSettings& settings) {
    install_stop_signals();
    const auto conductor = conductor_of(program, settings.network);
    ConductedNode node(program, options, file, settings);
    auto order = conductor->receive();
    while (order && order->kind == LockStepKind::kBegin) order = node.run_trial(*conductor, *order);
    if (!node.report().is_null()) save(options.report, node.report());
    if (!order || order->kind == LockStepKind::kEnd) return static_cast<int>(ExitCode::kOk);
    throw Error(ExitCode::kNetwork,
                "lock-step: received a message of kind {}, where a begin or end was expected",
                static_cast<int>(order->kind));
}

int run(const NodeProgram& program, const Options& options) {
    if (options.launcher != 0) stop_with_parent(options.launcher);
    const ConfigFile file = options.config.empty() ? ConfigFile::empty() : ConfigFile::load(options.config);
    SharedSettings settings = read_config(program, file);
    if (!options.report.empty()) {  // when the session is over, it would be too late
        refuse_folder(options.report);
        make_folder(std::filesystem::path(options.report).parent_path());
    }
    auto& [network, runtime, logging] = settings;
    if (options.base_port != 0) network.base_port = static_cast<std::uint16_t>(options.base_port);
    if (options.lock_step) return run_by_conductor(program, options, file, settings);
    const std::filesystem::path log_file = log_path(program, options, logging);
    const auto log = log_file.empty() ? nullptr : std::make_unique<MessageLog>();
    Sockets sockets(network);
    if (log) sockets.record_to(*log, logging.messages == LoggedMessages::kAll && !program.relays);
    if (options.launcher == 0) warn_if_unprotected(network);  // the launcher has warned already
    const WatchedInstance instance(program, file, sockets, system_entropy(), kPluginLimit);
    install_stop_signals(QuitSignal::kStopsEverything);
    if (log) {
        log->start(log_file, log_origin(program, options, file), logging);
        instance->process().record_with(*log);
    }
    instance->bring_up();
    RealtimeLoop loop(sockets.listeners());
    spdlog::info("ready, ports from {}", network.base_port);
    ServiceNotice notice;
    Guarded process(instance->process(), sockets.security());
    if (instance->has_foreground()) {
        run_beside_foreground(*instance, process, runtime, loop, notice);
    } else {
        // Not beside a window, which needs a core of its own.
        if (const std::string warning = keep_to_core(read_core(file)); !warning.empty())
            spdlog::warn(warning);
        run_process(*instance, process, runtime, loop, notice);
    }
    auto report = describe_program(program, *instance, sockets, instance->process().counters(),
                                   loop.statistics(), instance->process().overruns());
    if (log) {
        note_stale(*log, report);
        report["log"] = describe_log(log->close());
    }
    save(options.report, report);
    if (log && !log->fault().empty()) return static_cast<int>(ExitCode::kRunFailed);
    return check_deadlines(options, runtime, loop.statistics());
}

}  // namespace

nlohmann::ordered_json quantiles(const Histogram& h) {
    return {{"median_us", microseconds(h.quantile(0.5))},
            {"p99_us", microseconds(h.quantile(0.99))},
            {"worst_us", microseconds(h.worst())},
            {"count", h.count()}};
}

int run_node_program(const NodeProgram& program, int argc, char** argv) {
    return guarded_main(program.name, [&] {
        CLI::App app(program.description, program.name);
        Options options;
        app.add_option("session", options.config, "session file (TOML); default: the paper's settings")
            ->type_name("FILE");
        app.add_option("--base-port", options.base_port, "first UDP port, instead of [network] base_port")
            ->check(CLI::Range(1024, 65536 - static_cast<int>(Port::kCount)))
            ->type_name("PORT");
        app.add_option("--report", options.report, "write counters and lateness to this JSON file at the end")
            ->type_name("FILE");
        app.add_option("--log", options.log,
                       "write the messages that [log] selects to this new MCAP file (docs/log.md)")
            ->type_name("FILE");
        app.add_flag("--strict-rt", options.strict_rt, "exit with 4 if too many deadlines were missed");
        app.add_flag("--lock-step", options.lock_step,
                     "take the time from standard input (set by thimble run --clock lock-step)");
        app.add_flag("--die-with-parent", options.launcher, kDieWithParentHelp);
        if (program.add_options) program.add_options(app);
        app.set_version_flag("--version", std::string(kVersion));
        app.footer(
            "Example:\n  " + program.example +
            "\n\nExit codes: 0 ok, 1 failed, 2 usage or configuration, 3 network, 4 real time, 5 data.");
        if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
        return run(program, options);
    });
}

}  // namespace thimble
