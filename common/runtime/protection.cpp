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
                "cannot keep the lab key out of core dumps: {}; does a seccomp filter forbid setrlimit or "
                "prctl here?",
                std::strerror(errno));
}

namespace {

// Empty: all are on this machine.
std::string host_elsewhere(const NetworkSettings& settings) {
    const auto& hosts = settings.hosts;
    const auto outside = std::find_if(hosts.begin(), hosts.end(), leaves_this_machine);
    return outside == hosts.end() ? std::string() : *outside;
}

}  // namespace

void require_protection(const NetworkSettings& settings) {
    const SecuritySettings& security = settings.security;
    if (security.mode == SecurityMode::kLabKey) return;
    if (security.mode == SecurityMode::kNone && security.allow_unprotected_network) return;
    const std::string outside = host_elsewhere(settings);
    if (outside.empty()) return;
    throw Error(ExitCode::kUsage,
                "[network] names the host '{}', which is another machine or has no address here, but "
                "[security] mode \"{}\" does not protect traffic between machines: make a key with 'thimble "
                "keygen', copy it to each machine and set mode = \"lab-key\" (docs/security.md). To work "
                "without protection, set mode = \"none\" and allow_unprotected_network = true",
                outside, to_string(security.mode));
}

void require_protection_of_handle(const NetworkSettings& settings) {
    if (settings.security.mode != SecurityMode::kNone) return;
    const std::string outside = host_elsewhere(settings);
    if (outside.empty()) return;
    throw Error(
        ExitCode::kUsage,
        "a real handle or robot accepts no commands from an unprotected network, but [network] names the "
        "host '{}': set [security] mode = \"lab-key\" (docs/security.md), or use device = \"simulated\"",
        outside);
}

void require_protection_of_device(const SecuritySettings& settings, const std::string& host) {
    if (settings.allow_unprotected_network || !leaves_this_machine(host)) return;
    throw Error(
        ExitCode::kUsage,
        "the traffic with the device at '{}' would cross the network without protection: connect the device "
        "to this machine, or set [security] allow_unprotected_network = true (docs/security.md)",
        host);
}

void require_protection_of_dds(const SecuritySettings& settings, std::string_view table,
                               const std::string& interface) {
    if (settings.allow_unprotected_network || !leaves_this_machine(interface)) return;
    throw Error(ExitCode::kUsage,
                "[{}] interface: '{}' is not this machine alone, and DDS has no protection there: use "
                "127.0.0.1, or set [security] allow_unprotected_network = true (docs/security.md)",
                table, interface);
}

void warn_if_unprotected(const NetworkSettings& settings) {
    if (settings.security.mode != SecurityMode::kNone) return;
    const bool here = host_elsewhere(settings).empty();
    spdlog::warn(
        "datagrams are not protected ([security] mode is \"none\"): anybody on {} can move the needle; {}",
        here ? "this machine" : "the network",
        here ? "remove mode (docs/security.md)" : "make a key with 'thimble keygen' (docs/security.md)");
}

NetworkSettings without_user_key(NetworkSettings settings) {
    if (settings.security.mode == SecurityMode::kUserKey) settings.security.mode = SecurityMode::kNone;
    return settings;
}

std::unique_ptr<Security> make_security(const NetworkSettings& settings) {
    const SecuritySettings& security = settings.security;
    if (security.mode == SecurityMode::kNone) return nullptr;
    prepare_security();
    const RandomBytes random = system_random_bytes();
    if (security.mode == SecurityMode::kLabKey) hide_memory();
    const LabKey key = security.mode == SecurityMode::kUserKey
                           ? own_user_key(random)
                           : read_lab_key(lab_key_file(security.key_file));
    return std::make_unique<Security>(std::make_shared<const LabKey>(key_of_rig(key, settings.rig())),
                                      random);
}

}  // namespace thimble
