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
    CLI::App* keygen =
        app.add_subcommand("keygen", "make a key that protects the datagrams of all sessions of a lab");
    keygen->add_option(
        "file", *file,
        "new key file; default: THIMBLE_LAB_KEY_FILE, else thimble/lab.key in XDG_CONFIG_HOME or ~/.config");
    keygen->footer(
        "Only you can read the key (mode 0600), and the command overwrites no file.\n"
        "\n"
        "Examples:\n"
        "  thimble keygen\n"
        "  thimble keygen lab2.key\n"
        "  ssh thimble@robot.lab 'mkdir -p .config/thimble && umask 077 && cat > .config/thimble/lab.key' < "
        "~/.config/thimble/lab.key\n"
        "Manual: docs/security.md.");
    return {keygen, [file] {
                hide_memory();
                prepare_security();
                const auto path = new_lab_key_file(*file);
                create_lab_key(path, system_random_bytes());
                fmt::print("{}\n", path.string());
                return 0;
            }};
}

}  // namespace thimble
