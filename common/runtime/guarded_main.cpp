// How a program ends: what it throws becomes a reason on standard error and an exit code.
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>

#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/standard_streams.hpp"

namespace thimble {
namespace {

// Time to write the last messages; the reader of a pipe may be gone.
constexpr Duration kFarewell = std::chrono::seconds{1};

int end_without_memory() {
    std::fputs("error: no memory is left: end other programs, or raise the memory limit of this one\n",
               stderr);
    return static_cast<int>(ExitCode::kRunFailed);
}

std::atomic<bool> memory_refused{false};
[[maybe_unused]] const std::new_handler new_handler_before = std::set_new_handler([] {
    memory_refused = true;
    throw std::bad_alloc();
});

// Some library functions allocate but may not throw (std::filesystem, the destructor of a JSON value). Without memory they call
// std::terminate. The program then prints the reason and ends with exit code 1.
const std::terminate_handler terminate_before = std::set_terminate([] {
    if (memory_refused) std::_Exit(end_without_memory());
    terminate_before();
});

// The exit code of `body`, or of what it throws.
int run_guarded(const std::function<int()>& body) {
    try {
        return body();
    } catch (const ResultsLost& lost) {
        return static_cast<int>(lost.code());
    } catch (const Error& error) {
        spdlog::error(error.what());
        return static_cast<int>(error.code());
    } catch (const std::filesystem::filesystem_error& error) {
        spdlog::error("{}: {}; check that the folder exists and its permissions", error.path1().string(),
                      error.code().message());
        return static_cast<int>(ExitCode::kUsage);
    } catch (const std::bad_alloc&) {
        return end_without_memory();
    } catch (const std::exception& error) {
        // fmt::print() throws when a print to standard output fails.
        if (std::ferror(stdout) == 0) spdlog::error("unexpected error: {}", error.what());
        return static_cast<int>(ExitCode::kRunFailed);
    }
}

}  // namespace

int guarded_main(const std::string& name, const std::function<int()>& body) {
    open_standard_descriptors();
    std::signal(SIGPIPE, SIG_IGN);  // a reader that leaves ends no trial; lost results are noticed at the end
    std::signal(SIGCHLD, SIG_DFL);  // ignored, as some parents hand it down, it leaves no exit codes
    const int ended = run_guarded([&] {
        log_to_stderr(name);
        return body();
    });
    return run_guarded([ended] {
        stderr_written_within(kFarewell);  // before the results that wait in stdout's buffer
        const int code = settle_results(ended);
        stderr_written_within(kFarewell);
        return code;
    });
}

}  // namespace thimble
