#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

constexpr Duration kLookAgain = std::chrono::milliseconds{20};

}  // namespace

void await_user(const std::function<std::string()>& awaits, Duration limit, std::string_view key) {
    const SessionTime end = wall_now() + limit;
    std::string said;
    for (std::string request = awaits(); !request.empty(); request = awaits()) {
        if (stop_requested()) throw Error(ExitCode::kRunFailed, "interrupted; " + request);
        if (wall_now() > end)
            throw Error(ExitCode::kRunFailed, "{} (waited for {} s{}{})", request, to_seconds(limit),
                        key.empty() ? "" : ", ", key);
        if (request != said) spdlog::warn(request);
        said = request;
        wall_sleep(kLookAgain);
    }
}

}  // namespace thimble
