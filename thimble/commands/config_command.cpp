// thimble config: every key of a session, scene or network profile file, as the programs know it.
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "thimble/commands/commands.hpp"
#include "thimble/commands/config_reference.hpp"

namespace thimble {

Subcommand add_config(CLI::App& app) {
    const auto json = std::make_shared<bool>(false);
    const auto schema = std::make_shared<bool>(false);
    const auto kind = std::make_shared<std::string>("session");
    CLI::App* config = app.add_subcommand(
        "config", "every key of a session, scene or profile file: type, unit, default, range, meaning");
    CLI::App* reference = config->add_subcommand("reference", "all keys as a page in Markdown, or as JSON");
    config->require_subcommand(1);
    reference->add_flag("--json", *json, "one JSON object by dotted key");
    reference
        ->add_flag("--schema", *schema,
                   "a JSON Schema, by which an editor checks a file and completes its keys")
        ->excludes("--json");
    reference->add_option("--kind", *kind, "of which files: session, scene, or profile (of a network)")
        ->check(CLI::IsMember({"session", "scene", "profile"}))
        ->capture_default_str();
    reference->footer(
        "Examples:\n  thimble config reference --json | grep -A5 force_limit_N\n"
        "  thimble config reference --schema > session.schema.json\n"
        "  thimble config reference --kind scene");
    return {config, [json, schema, kind] {
                const auto keys = *kind == "session" ? session_file_keys()
                                  : *kind == "scene" ? scene_file_keys()
                                                     : profile_file_keys();
                fmt::print("{}", *json     ? keys_as_json(keys)
                                 : *schema ? keys_as_schema(keys)
                                           : keys_as_markdown(keys));
                return 0;
            }};
}

}  // namespace thimble
