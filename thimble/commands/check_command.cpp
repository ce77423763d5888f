// thimble check: what is wrong with a session file.
#include <chrono>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "session/settings/system_settings.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/shared.hpp"

namespace thimble {
namespace {

// No path on Earth, nor to the moon and back, is as long: the value is probably in milliseconds.
void warn_of_milliseconds(const SessionPlan& plan) {
    constexpr Duration kLongest = std::chrono::seconds{3};
    for (const Duration delay : plan.delays) {
        if (delay < kLongest) continue;
        const double delay_s = to_seconds(delay);
        spdlog::warn("'session.delays_s' holds {} s; if you meant {} ms, write {}", delay_s, delay_s,
                     delay_s / 1000);
    }
}

int check_config(const std::string& config) {
    const SystemSettings settings = load_system_settings(config);
    check_build(settings);
    warn_of_milliseconds(settings.plan);
    for (const std::string& warning : named_modalities(settings.instructions)) spdlog::warn(warning);
    fmt::print("{}: good\n", config);
    return 0;
}

}  // namespace

Subcommand add_check(CLI::App& app) {
    const auto config = std::make_shared<std::string>();
    CLI::App* check = app.add_subcommand("check", "read a session file and say what is wrong with it");
    check->add_option("session", *config, "session file (TOML)")->required();
    check->footer("Example:\n  thimble check deploy/sessions/delay50.toml");
    return {check, [config] { return check_config(*config); }};
}

}  // namespace thimble
