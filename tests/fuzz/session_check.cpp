#include <cmath>
#include <string>

#include "common/error.hpp"
#include "session/settings/system_settings.hpp"
#include "tests/fuzz/checks.hpp"

namespace thimble {
namespace {

bool limit(double value) { return std::isfinite(value) && value > 0; }

std::string flaw_of_settings(const SystemSettings& settings) {
    if (!limit(settings.master.guard.force_limit_N)) return "a handle without a limit of its force";
    if (!limit(settings.cutaneous.force_limit_N)) return "fingers without a limit of their force";
    if (settings.master.stale.after <= Duration{0}) return "a handle whose force never goes stale";
    if (settings.cutaneous.stale.after <= Duration{0}) return "fingers whose force never goes stale";
    if (settings.session.contact_hold <= Duration{0}) return "a trial without a hold";
    if (settings.plan.modalities.empty()) return "nothing to run";
    (void)session_settings(settings);
    return "";
}

}  // namespace

Verdict check_session(Bytes bytes) {
    const std::string text(text_of(bytes));
    // Session files may name others; what never ends (/dev/zero) or blocks is the author's own to avoid.
    if (text.find('/') != std::string::npos) return {};
    try {
        return {true, flaw_of_settings(read_system_settings(ConfigFile::parse(text, "fuzz.toml")))};
    } catch (const Error& error) {
        const bool named = error.code() == ExitCode::kUsage || error.code() == ExitCode::kData;
        if (!named) return {false, "an Error that is about neither usage nor data"};
        return {false, *error.what() != '\0' ? "" : "an Error that says nothing"};
    }
}

}  // namespace thimble
