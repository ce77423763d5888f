// thimble config: every key of a session file, as the programs know it.
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "experiment/commands/commands.hpp"
#include "experiment/config_reference.hpp"

namespace thimble {

Subcommand add_config(CLI::App& app) {
    const auto json = std::make_shared<bool>(false);
    CLI::App* config = app.add_subcommand("config", "every key of a session file: type, default, range");
    CLI::App* reference = config->add_subcommand("reference", "all keys as a page in Markdown, or as JSON");
    config->require_subcommand(1);
    reference->add_flag("--json", *json, "one JSON object by dotted key");
    reference->footer("Example:\n  thimble config reference --json | grep -A4 force_limit_N");
    return {config, [json] {
                const auto keys = session_file_keys();
                fmt::print("{}", *json ? keys_as_json(keys) : keys_as_markdown(keys));
                return 0;
            }};
}

}  // namespace thimble
