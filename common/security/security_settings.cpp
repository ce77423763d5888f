#include "common/security/security_settings.hpp"

namespace thimble {

SecuritySettings read_security_settings(const ConfigFile& file) {
    const ConfigTable table = file.table("security");
    SecuritySettings settings;
    settings.mode_given = table.has("mode");
    settings.mode =
        table.choice("mode", 0, {"none", "lab-key"}) == 0 ? SecurityMode::kNone : SecurityMode::kLabKey;
    settings.allow_unprotected_network = table.boolean("allow_unprotected_network", false);
    settings.key_file = table.text("key_file", "");
    if (!settings.key_file.empty() && settings.mode == SecurityMode::kNone)
        table.fail("key_file", "is of no use without mode = \"lab-key\"");
    return settings;
}

}  // namespace thimble
