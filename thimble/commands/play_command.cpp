// thimble play: feel the experiment with a mouse.
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/own_program.hpp"
#include "common/process/child.hpp"
#include "common/process/progress.hpp"
#include "common/runtime/protection.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/text_file.hpp"
#include "session/participant/dataset.hpp"
#include "session/play/order_handlers.hpp"
#include "session/play/play_session.hpp"
#include "session/play/replay_process.hpp"
#include "session/play/replay_session.hpp"
#include "session/render/render.hpp"
#include "session/virtual/energy_demand.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/shared.hpp"

namespace thimble {
namespace {

struct PlayArguments {
    PlayOptions play;
    ReplayPlayOptions replay;
    RenderPlan render;
    std::string config, modality, visual_command, video, view = "cutaway";
    std::optional<double> delay_s;
    double seconds = 0;
    int base_port = 0;
    bool browser = false;
};

// Beside the programs where they are installed, or in the tree that built them.
std::filesystem::path find_page() {
    const std::filesystem::path up = program_folder().parent_path();
    const std::array places{up / "share/thimble/thimble.html", up.parent_path() / "browser/thimble.html"};
    std::error_code absent;
    for (const std::filesystem::path& place : places)
        if (std::filesystem::exists(place, absent)) return place;
    throw Error(ExitCode::kUsage,
                "the page is neither at {} nor at {}: build it with ./deploy/browser (docs/browser.md)",
                places[0].string(), places[1].string());
}

int open_page(const CLI::App& play) {
    for (const CLI::Option* option : play.get_options()) {
        if (option->count() > 0 && option->get_name() != "--browser")
            throw Error(ExitCode::kUsage, "thimble play --browser takes no other option: leave {} out",
                        option->get_name());
    }
    const std::string page = find_page().string(), advice = "open file://" + page + " in a browser";
    fmt::print("file://{}\n", page);
    std::fflush(stdout);  // xdg-open may wait until the browser ends
    const ProgramResult result = run_program("xdg-open", {page}, ".", advice + ", or install xdg-utils");
    if (result.exit_code != 0)
        throw Error(ExitCode::kRunFailed, "xdg-open cannot show the page: {}; {}", result.output, advice);
    return static_cast<int>(ExitCode::kOk);
}

int render_recorded(PlayArguments& a, const SystemSettings& settings) {
    RenderPlan& plan = a.render;
    if (plan.frames.empty()) plan.frames = a.video + "_frames";
    if (!a.video.empty()) plan.video = a.video;
    plan.visual = settings.visual;
    plan.visual.cut_away = a.view == "cutaway";
    const RecordedTrial trial = find_recorded_trial(a.replay.folder, a.replay.trial, a.replay.contact_hold_s);
    std::optional<Progress> progress{std::in_place};
    plan.progress = [&](std::size_t done, std::size_t all) {
        progress->show(progress_text(done, all, "frames", ""), done % 100 == 0);
    };
    const RenderResult result = render_trial(trial, plan);
    progress.reset();  // before anything on stdout
    fmt::print("{} frames: {}{}\n", result.frames, plan.frames.string(),
               plan.video && result.complete ? ", " + plan.video->string() : "");
    if (!result.complete) spdlog::error("interrupted; the {} finished frames are kept", result.frames);
    return static_cast<int>(result.complete ? ExitCode::kOk : ExitCode::kRunFailed);
}

// As typed, else the first modality and the first delay of the session.
void choose_first_trial(PlayArguments& a, const SessionPlan& plan) {
    if (plan.names_modalities) a.play.modality = plan.modalities.front();
    if (!a.modality.empty()) a.play.modality = *find_modality(a.modality);
    if (plan.names_delays) a.play.delay_s = to_seconds(plan.delays.front());
    if (a.delay_s) a.play.delay_s = *a.delay_s;
    if (a.play.delay_s <= PlayHandler::kLongestDelay_s) return;
    throw Error(ExitCode::kUsage, fmt::format("the session delays the force by {} s, but thimble play allows "
                                              "at most {} s: set a shorter delay with --delay-s",
                                              a.play.delay_s, PlayHandler::kLongestDelay_s));
}

// Throws Error (usage): the session is not one to play. A replay shows what was recorded.
void require_playable(const SystemSettings& settings) {
    if (settings.launch.anywhere_else()) {
        throw Error(ExitCode::kUsage,
                    "thimble play starts every program on this machine, but the session file's [launch] "
                    "names other machines: remove [launch]");
    }
    settings.launch.require_no_own_program("thimble play");
    if (settings.slave.device != SlaveDevice::kSimulated)
        throw Error(ExitCode::kUsage,
                    "thimble play has a simulated needle, but [slave_sim] device is \"ros2\": remove that "
                    "key, or use thimble run");
}

int run_play(PlayArguments a) {
    const SystemSettings settings = load_system_settings(a.config);
    const bool replays = !a.replay.folder.empty();
    if (!replays) {
        require_playable(settings);
        choose_first_trial(a, settings.plan);
    }
    a.play.network = a.replay.network = network_of(a.config, a.base_port);
    a.play.stop = a.replay.stop = a.render.stop = &stop_requested();
    a.replay.contact_hold_s = to_seconds(settings.slave.contact_hold);
    if (a.seconds > 0) a.play.longest = a.replay.longest = from_seconds(a.seconds);
    if (!a.play.record.empty()) refuse_dataset(a.play.record);
    if (!a.render.frames.empty() || !a.video.empty()) {
        install_stop_signals();
        return render_recorded(a, settings);
    }
    if (a.visual_command.empty()) check_window(program_folder());
    const auto visual_command = words_of(a.visual_command);
    a.play.starter = a.replay.starter = std::make_shared<PlayStarter>(
        program_folder(), a.config, std::vector<std::string>(visual_command.begin(), visual_command.end()),
        settings.handle.kind != HandleKind::kHid, a.view);
    install_stop_signals(replays ? QuitSignal::kEnds : QuitSignal::kStopsEverything);
    warn_if_unprotected(a.play.network);
    const std::string warning = replays ? "" : energy_warning(settings, {from_seconds(a.play.delay_s)});
    if (!warning.empty()) spdlog::warn(warning);
    if (replays) {
        play_recorded(a.replay);
    } else {
        const PlayResult result = play(settings, a.play);
        fmt::print("{} trials{}\n", result.trials,
                   a.play.record.empty() ? "" : ": " + a.play.record.string());
    }
    return static_cast<int>(ExitCode::kOk);
}

void add_render_options(CLI::App& play, CLI::Option* replay, PlayArguments& a) {
    const auto group = "Pictures of a replay";
    play.add_option("--frames", a.render.frames, "folder for one PNG file per frame; opens no window")
        ->type_name("FOLDER")
        ->needs(replay)
        ->group(group);
    play.add_option(
            "--video", a.video,
            "video file, made with ffmpeg, e.g. trial.mp4; its frames are kept beside it, or in --frames")
        ->type_name("FILE")
        ->needs(replay)
        ->group(group);
    play.add_option("--frames-per-s", a.render.frames_per_s, "frames per second of the trial")
        ->default_val(a.render.frames_per_s)
        ->check(CLI::Range(1.0, 1000.0))
        ->needs(replay)
        ->group(group);
    play.add_flag("--overwrite", a.render.overwrite, "replace existing frames and video")
        ->needs(replay)
        ->group(group);
}

}  // namespace

Subcommand add_play(CLI::App& app) {
    const auto arguments = std::make_shared<PlayArguments>();
    CLI::App* sub =
        app.add_subcommand("play", "feel the experiment with the mouse, in a window on this machine");
    add_session_option(*sub, arguments->config,
                       "session file (TOML) or built-in name; default: the paper's scene");
    sub->add_option("--modality", arguments->modality,
                    "how the first trial shows the force; default: the session's first (HF). HF: at the "
                    "handle; CF: on the fingers that hold it; CCF: on the other hand; VF: as a bar")
        ->check(CLI::IsMember({"HF", "CF", "CCF", "VF"}));
    sub->add_option("--delay-s", arguments->delay_s,
                    "one-way delay of the force in the first trial, s; default: the session's first (0.05)")
        ->check(CLI::Range(0.0, PlayHandler::kLongestDelay_s));
    CLI::Option* out = sub->add_option("-o,--out", arguments->play.record,
                                       "folder for the results, as of thimble run; default: keep nothing")
                           ->type_name("FOLDER");
    CLI::Option* replay =
        sub->add_option("--replay", arguments->replay.folder,
                        "show a recorded trial from this folder (trials.csv, trajectories/)")
            ->type_name("FOLDER")
            ->excludes(out);
    sub->add_option("--trial", arguments->replay.trial, "which trial: its line in trials.csv, from 1")
        ->default_val(arguments->replay.trial)
        ->check(CLI::Range(1, 1000000))
        ->needs(replay);
    sub->add_option("--speed", arguments->replay.speed, "speed of the replay; 1: as recorded")
        ->default_val(arguments->replay.speed)
        ->check(CLI::Range(ReplayClock::kSlowest, ReplayClock::kFastest))
        ->needs(replay);
    sub->add_option("--view", arguments->view,
                    "cutaway: also shows the needle inside the tissue and the fixture; subject: the picture "
                    "of the paper's subjects")
        ->default_val(arguments->view)
        ->check(CLI::IsMember({"cutaway", "subject"}));
    sub->add_flag("--browser", arguments->browser,
                  "open the page in a browser, for machines without OpenGL; takes no other option");
    add_render_options(*sub, replay, *arguments);
    add_base_port_option(*sub, arguments->base_port);
    sub->add_option("--seconds", arguments->seconds,
                    "end after this time, s; default: run until the window is closed")
        ->check(CLI::Range(0.001, 1e6));
    for (const char* pictures : {"--frames", "--video"})
        sub->get_option(pictures)->excludes("--speed", "--seconds");
    replay->excludes("--modality", "--delay-s");
    sub->add_option("--visual-command", arguments->visual_command,
                    "program that draws the window; default: thimble-visual")
        ->type_name("COMMAND");
    sub->footer(
        "Examples:\n  thimble play --modality HF --delay-s 0.05 --out out/play\n"
        "  thimble play --replay out/play --trial 2 --speed 0.5\n"
        "  thimble play --replay out/play --trial 2 --video trial2.mp4\n"
        "  thimble play --browser\n"
        "Manual: docs/play.md.");
    return {sub, [sub, arguments] { return arguments->browser ? open_page(*sub) : run_play(*arguments); }};
}

}  // namespace thimble
