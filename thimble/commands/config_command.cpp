// thimble config: every key of a session, scene or network profile file, as the programs know it.
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "thimble/commands/commands.hpp"
#include "thimble/commands/config_reference.hpp"

namespace thimble {
namespace {

constexpr const char* kReferenceExamples =
    "  thimble config reference --json | grep -A5 force_limit_N\n"
    "  thimble config reference scene\n";
constexpr const char* kSchemaExamples =
    "  thimble config schema session > session.schema.json\n"
    "  thimble config schema scene > scene.schema.json\n";
constexpr const char* kConfigExitCodes = "Exit codes: 0 ok, 1 not written, 2 usage.";

struct ConfigArguments {
    std::string kind = "session";
    bool json = false, schema = false;
};

int print_keys(const ConfigArguments& a) {
    const auto keys = a.kind == "session" ? session_file_keys()
                      : a.kind == "scene" ? scene_file_keys()
                      : a.kind == "pages" ? page_file_keys()
                                          : profile_file_keys();
    fmt::print("{}", a.json ? keys_as_json(keys) : a.schema ? keys_as_schema(keys) : keys_as_markdown(keys));
    return 0;
}

CLI::App* add_keys(CLI::App& config, ConfigArguments& a, const char* name, const char* what,
                   const char* examples) {
    CLI::App* part = config.add_subcommand(name, what);
    part->footer(fmt::format("Examples:\n{}\n{}", examples, kConfigExitCodes));
    part->add_option("kind", a.kind,
                     "kind of file: session, scene, pages (that a subject reads), or profile (of a network)")
        ->check(CLI::IsMember({"session", "scene", "pages", "profile"}))
        ->capture_default_str();
    return part;
}

}  // namespace

Subcommand add_config(CLI::App& app) {
    const auto arguments = std::make_shared<ConfigArguments>();
    ConfigArguments& a = *arguments;
    CLI::App* config = app.add_subcommand(
        "config", "print every key of a session, scene, page or profile file, with unit and range");
    config->require_subcommand(1);
    add_keys(*config, a, "reference", "print all keys as a Markdown page, or as JSON", kReferenceExamples)
        ->add_flag("--json", a.json, "print one JSON object, with the dotted keys as names");
    add_keys(*config, a, "schema",
             "print a JSON Schema, with which an editor checks a file and completes its keys",
             kSchemaExamples)
        ->callback([&a] { a.schema = true; });
    config->footer(fmt::format("Examples:\n{}{}\n{}", kReferenceExamples, kSchemaExamples, kConfigExitCodes));
    return {config, [arguments] { return print_keys(*arguments); }};
}

}  // namespace thimble
