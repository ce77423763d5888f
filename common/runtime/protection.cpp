#include "common/runtime/protection.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <sys/prctl.h>
#include <sys/resource.h>

#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/runtime/udp_channel.hpp"
#include "common/security/lab_key_file.hpp"

namespace thimble {

void hide_memory() {
    const rlimit none{0, 0};
    const bool hidden = setrlimit(RLIMIT_CORE, &none) == 0 && prctl(PR_SET_DUMPABLE, 0UL, 0UL, 0UL, 0UL) == 0;
    if (hidden) return;
    throw Error(ExitCode::kRunFailed,
                "cannot keep the lab key out of core dumps: {}; something on this machine forbids setrlimit "
                "or prctl to this program (a seccomp filter?)",
                std::strerror(errno));
}

void require_protection(const NetworkSettings& settings) {
    if (settings.security.mode != SecurityMode::kNone) return;
    if (settings.security.mode_given && settings.security.allow_unprotected_network) return;
    const auto& hosts = settings.hosts;
    const auto outside = std::find_if(hosts.begin(), hosts.end(), leaves_this_machine);
    if (outside == hosts.end()) return;
    throw Error(ExitCode::kUsage,
                "[network] names the host '{}', which is not this machine or cannot be resolved here, and "
                "anybody between the machines could move the needle: make a key with 'thimble keygen', copy "
                "it to each machine and set [security] mode = \"lab-key\" (docs/security.md). To do without, "
                "say both mode = \"none\" and allow_unprotected_network = true",
                *outside);
}

void require_protection_of_device(const SecuritySettings& settings, const std::string& host) {
    if (settings.allow_unprotected_network || !leaves_this_machine(host)) return;
    throw Error(
        ExitCode::kUsage,
        "the device at '{}' is spoken to over the network in a protocol that has no protection: connect it "
        "to this machine, or say [security] allow_unprotected_network = true (docs/security.md)",
        host);
}

void warn_if_unprotected(const NetworkSettings& settings) {
    if (settings.security.mode != SecurityMode::kNone) return;
    const auto& hosts = settings.hosts;
    if (std::none_of(hosts.begin(), hosts.end(), leaves_this_machine)) return;
    spdlog::warn(
        "datagrams between machines are not protected ([security] mode is none): anybody on the network can "
        "move the needle; make a key with 'thimble keygen' (docs/security.md)");
}

std::unique_ptr<Security> make_security(const SecuritySettings& settings) {
    if (settings.mode == SecurityMode::kNone) return nullptr;
    hide_memory();
    prepare_security();
    auto key = std::make_shared<const LabKey>(read_lab_key(lab_key_file(settings.key_file)));
    return std::make_unique<Security>(std::move(key), system_random_bytes());
}

}  // namespace thimble
