// libFuzzer on session files: whatever the text, all readers of settings together give settings whose limits stand, or an Error
// about usage (or about the data of a file that the text names).
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "common/error.hpp"
#include "session/settings/system_settings.hpp"

namespace {

using namespace thimble;

void require_session(bool holds, const char* what) {
    if (holds) return;
    std::fprintf(stderr, "fuzz_session: %s\n", what);
    std::abort();
}

bool limit(double value) { return std::isfinite(value) && value > 0; }

void look_at(const SystemSettings& settings) {
    require_session(limit(settings.master.guard.force_limit_N), "a handle without a limit of its force");
    require_session(limit(settings.cutaneous.force_limit_N), "fingers without a limit of their force");
    require_session(settings.master.stale.after > Duration{0}, "a handle whose force never goes stale");
    require_session(settings.cutaneous.stale.after > Duration{0}, "fingers whose force never goes stale");
    require_session(settings.session.contact_hold > Duration{0}, "a trial without a hold");
    require_session(!settings.plan.modalities.empty(), "nothing to run");
    (void)session_settings(settings);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(reinterpret_cast<const char*>(data), size);
    // Session files may name others; what never ends (/dev/zero) or blocks is the author's own to avoid.
    if (text.find('/') != std::string::npos) return -1;
    try {
        look_at(read_system_settings(ConfigFile::parse(text, "fuzz.toml")));
    } catch (const Error& error) {
        require_session(error.code() == ExitCode::kUsage || error.code() == ExitCode::kData,
                        "an Error that is about neither usage nor data");
        require_session(*error.what() != '\0', "an Error that says nothing");
    }
    return 0;
}
