// thimble play: feel the experiment with a mouse.
#include <memory>
#include <sstream>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/process/progress.hpp"
#include "common/runtime/protection.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "session/play/play_handler.hpp"
#include "session/play/play_session.hpp"
#include "session/play/replay_clock.hpp"
#include "session/play/replay_session.hpp"
#include "session/render/render.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/shared.hpp"

namespace thimble {
namespace {

struct RenderArguments {
    std::string frames, video;
    double frames_per_s = 30;
    bool overwrite = false;

    bool asked() const { return !frames.empty() || !video.empty(); }
};

struct PlayArguments {
    std::string config, record, modality = "HF", visual_command, replay;
    double delay_s = 0.05, seconds = 0, speed = 1;
    std::size_t trial = 1;
    int base_port = 0;
    RenderArguments render;
};

std::vector<std::string> words_of(const std::string& command) {
    std::istringstream stream(command);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    return words;
}

int run_recorded(const PlayArguments& arguments, const SystemSettings& settings, const PlayOptions& play) {
    ReplayPlayOptions options;
    options.starter = play.starter;
    options.network = play.network;
    options.folder = arguments.replay;
    options.trial = arguments.trial;
    options.speed = arguments.speed;
    options.contact_hold_s = to_seconds(settings.slave.contact_hold);
    options.longest = play.longest;
    options.stop = play.stop;
    play_recorded(options);
    return static_cast<int>(ExitCode::kOk);
}

int render_recorded(const PlayArguments& a, const SystemSettings& settings) {
    RenderPlan plan;
    plan.frames = a.render.frames.empty() ? a.render.video + "_frames" : a.render.frames;
    if (!a.render.video.empty()) plan.video = a.render.video;
    plan.frames_per_s = a.render.frames_per_s;
    plan.overwrite = a.render.overwrite;
    plan.visual = settings.visual;
    plan.stop = &stop_requested();
    const RecordedTrial trial =
        find_recorded_trial(a.replay, a.trial, to_seconds(settings.slave.contact_hold));
    std::optional<Progress> progress{std::in_place};
    plan.progress = [&](std::size_t done, std::size_t all) {
        progress->show(fmt::format("frame {} of {}", done, all), done % 100 == 0);
    };
    const RenderResult result = render_trial(trial, plan);
    progress.reset();  // before anything on stdout
    fmt::print("{} frames: {}{}\n", result.frames, plan.frames.string(),
               plan.video && result.complete ? ", " + plan.video->string() : "");
    if (!result.complete) spdlog::error("interrupted; the {} frames done are kept", result.frames);
    return static_cast<int>(result.complete ? ExitCode::kOk : ExitCode::kRunFailed);
}

int run_play(const PlayArguments& arguments) {
    const SystemSettings settings = load_system_settings(arguments.config);
    if (settings.launch.anywhere_else()) {
        throw Error(ExitCode::kUsage,
                    "the session file's [launch] names other machines, and thimble play starts every node on "
                    "this one: "
                    "leave [launch] out");
    }
    PlayOptions options;
    options.network = network_of(arguments.config, arguments.base_port);
    options.modality = *find_modality(arguments.modality);
    options.delay_s = arguments.delay_s;
    options.record = arguments.record;
    if (arguments.seconds > 0) options.longest = from_seconds(arguments.seconds);
    options.stop = &stop_requested();
    if (arguments.render.asked()) {
        install_stop_signals();
        return render_recorded(arguments, settings);
    }
    if (arguments.visual_command.empty()) check_window(program_folder());
    options.starter =
        std::make_shared<PlayStarter>(program_folder(), arguments.config, words_of(arguments.visual_command),
                                      settings.handle.kind != HandleKind::kHid);
    const bool replays = !arguments.replay.empty();
    install_stop_signals(replays ? QuitSignal::kEnds : QuitSignal::kStopsEverything);
    warn_if_unprotected(options.network);
    if (replays) return run_recorded(arguments, settings, options);
    const PlayResult result = play(settings, options);
    fmt::print("{} trials{}\n", result.trials, arguments.record.empty() ? "" : ": " + arguments.record);
    return static_cast<int>(ExitCode::kOk);
}

void add_render_options(CLI::App& play, CLI::Option* replay, RenderArguments& a) {
    const auto group = "Pictures of a replay";
    play.add_option("--frames", a.frames, "folder for one PNG file per frame; nothing is shown")
        ->needs(replay)
        ->group(group);
    play.add_option("--video", a.video, "a video by ffmpeg, e.g. trial.mp4; frames beside it unless --frames")
        ->needs(replay)
        ->group(group);
    play.add_option("--frames-per-s", a.frames_per_s, "of the trial's time")
        ->default_val(a.frames_per_s)
        ->check(CLI::Range(1.0, 1000.0))
        ->needs(replay)
        ->group(group);
    play.add_flag("--overwrite", a.overwrite, "replace frames and video that are there")
        ->needs(replay)
        ->group(group);
}

}  // namespace

Subcommand add_play(CLI::App& app) {
    const auto arguments = std::make_shared<PlayArguments>();
    CLI::App* sub =
        app.add_subcommand("play", "feel the experiment with a mouse: every node on this machine, a window");
    sub->add_option("session", arguments->config, "session file (TOML); without it the paper's scene");
    sub->add_option("--modality", arguments->modality, "of the first trial: HF, CF, CCF or VF")
        ->default_val(arguments->modality)
        ->check(CLI::IsMember({"HF", "CF", "CCF", "VF"}));
    sub->add_option("--delay-s", arguments->delay_s, "one-way delay of the force path at the start")
        ->default_val(arguments->delay_s)
        ->check(CLI::Range(0.0, PlayHandler::kLongestDelay_s));
    sub->add_option("--record", arguments->record, "keep each trial in this folder, as thimble run does");
    CLI::Option* replay = sub->add_option("--replay", arguments->replay,
                                          "show a trial of this folder (trials.csv, trajectories/) instead");
    sub->add_option("--trial", arguments->trial, "which line of its trials.csv, from 1")
        ->default_val(arguments->trial)
        ->check(CLI::Range(1, 1000000))
        ->needs(replay);
    sub->add_option("--speed", arguments->speed, "of the replay; 1: as it was")
        ->default_val(arguments->speed)
        ->check(CLI::Range(ReplayClock::kSlowest, ReplayClock::kFastest))
        ->needs(replay);
    add_render_options(*sub, replay, arguments->render);
    add_base_port_option(*sub, arguments->base_port);
    sub->add_option("--seconds", arguments->seconds, "end by itself after so long")
        ->check(CLI::PositiveNumber);
    sub->add_option("--visual-command", arguments->visual_command,
                    "program and arguments instead of thimble-visual --window --view player")
        ->type_name("COMMAND");
    sub->footer(
        "Example:\n  thimble play --modality HF --delay-s 0.05 --record out/play\n"
        "  thimble play --replay out/play --trial 2 --speed 0.5\n"
        "  thimble play --replay out/play --trial 2 --video trial2.mp4\n"
        "Manual: docs/play.md.");
    return {sub, [arguments] { return run_play(*arguments); }};
}

}  // namespace thimble
