// `thimble play --replay`: thimble-visual alone, and a recorded trial.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "common/network_settings.hpp"
#include "common/process/progress.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/sockets.hpp"
#include "common/runtime/wall_clock.hpp"
#include "session/launch/node_kinds.hpp"
#include "session/play/play_starter.hpp"
#include "session/play/replay_process.hpp"
#include "session/records/condition_summary.hpp"

namespace thimble {

inline constexpr Duration kGlance = std::chrono::milliseconds{20};

inline constexpr Duration kWindowWithin = std::chrono::seconds{10};

inline constexpr Duration kGoodbye = std::chrono::seconds{1};

struct ReplayPlayOptions {
    std::shared_ptr<PlayStarter> starter;
    NetworkSettings network;
    std::filesystem::path folder;
    std::size_t trial = 1;
    double speed = 1;
    double contact_hold_s = 5;
    Duration longest = Duration::max();
    const std::atomic<bool>* stop = nullptr;
};

inline ReplayProcess::Channels open_replay_channels(Sockets& sockets) {
    return {sockets.between(Port::kSessionVisual, Port::kVisualControl), sockets.outlet(Port::kVisualForce),
            sockets.outlet(Port::kVisualScene), open_view_channels(sockets)};
}

inline std::shared_ptr<RunningNode> start_window(const ReplayPlayOptions& options,
                                                 const std::filesystem::path& logs) {
    NodeOrder order;
    order.role = Role::kVisual;
    order.program = "thimble-visual";
    order.arguments = {"--base-port", std::to_string(options.network.base_port)};
    order.log = logs / "thimble-visual.log";
    order.report = logs / "thimble-visual.json";
    return options.starter->start(order);
}

// At its end the replay stands still until the user closes the window or quits. Throws Error as find_recorded_trial() and play() do.
inline void play_recorded(const ReplayPlayOptions& options) {
    const RecordedTrial trial = find_recorded_trial(options.folder, options.trial, options.contact_hold_s);
    const TrialConditions& c = trial.record.conditions;
    Progress progress;
    progress.say(fmt::format("{}: {} {}, {:.1f} s", trial.file.string(), delay_text(c.delay_s),
                             to_string(c.modality), trial.duration_s()));
    const ScratchFolder logs;
    Sockets sockets(options.network);
    ReplayProcess replay(system_entropy(), trial, options.speed, open_replay_channels(sockets));
    std::optional<SecuredProcess> secured;
    if (sockets.security() != nullptr) secured.emplace(replay, *sockets.security());
    Process& process = secured ? static_cast<Process&>(*secured) : replay;
    RealtimeLoop loop(sockets.listeners());
    const auto window = start_window(options, logs.path());
    const SessionTime begin = wall_now();
    for (SessionTime now = begin; !replay.stopped(); now = wall_now()) {
        loop.step(process, now + kGlance);
        if (options.stop != nullptr && *options.stop) break;
        if (now - begin >= options.longest) break;
        const bool ended = window->poll().has_value();
        if (options.starter->window_closed()) return;
        if (ended) throw Error(window->verdict(), window->exit_message());
        if (replay.shows() || now - begin < kWindowWithin) continue;
        throw Error(ExitCode::kNetwork, "thimble-visual does not answer on ports from {} within {} s",
                    options.network.base_port, to_seconds(kWindowWithin));
    }
    replay.shut_down(wall_now());
    if (!wait_for_end(*window, kGoodbye)) window->stop();
    wait_for_end(*window, kGoodbye);
}

}  // namespace thimble
