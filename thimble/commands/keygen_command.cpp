// thimble keygen: a lab key.
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/runtime/protection.hpp"
#include "common/security/lab_key_file.hpp"
#include "thimble/commands/commands.hpp"

namespace thimble {
Subcommand add_keygen(CLI::App& app) {
    const auto file = std::make_shared<std::string>();
    CLI::App* keygen = app.add_subcommand(
        "keygen",
        "make a lab key, which protects every datagram of sessions with [security] mode = \"lab-key\"");
    keygen->add_option(
        "file", *file,
        "new file for the key; without it THIMBLE_LAB_KEY_FILE, else thimble/lab.key in XDG_CONFIG_HOME or "
        "~/.config");
    keygen->footer(
        "Examples:\n  thimble keygen\n  thimble keygen lab2.key\n"
        "  ssh thimble@robot.lab 'mkdir -p .config/thimble && umask 077 && cat > .config/thimble/lab.key' "
        "< ~/.config/thimble/lab.key\n\n"
        "The key is readable by you alone (mode 0600) and never overwrites a file. docs/security.md is the "
        "manual.");
    return {keygen, [file] {
                hide_memory();
                prepare_security();
                const auto path = lab_key_file(*file);
                create_lab_key(path, system_random_bytes());
                fmt::print("{}\n", path.string());
                return 0;
            }};
}

}  // namespace thimble
