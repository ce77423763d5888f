#include "master/devices/falcon/falcon_guardian.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <new>
#include <span>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"
#include "master/devices/falcon/falcon_exchange.hpp"
#include "master/devices/falcon/falcon_link.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Duration kLook = milliseconds{10};
// Longer than any turn: a write to the USB may take 100 ms. Counted in looks, not in time: a machine that stood still
// does not make the guardian late.
constexpr int kLooksWithoutTurn = 25;
// To take the force away: the kernel may still hold the device, or find it anew after a fault of the USB.
constexpr Duration kTakeLimit = seconds{2}, kTakeAgain = milliseconds{50};
constexpr int kWords =
    6;  // program, kFalconGuardian, serial, firmware, its SHA-256, priority (0: not in real time)

std::vector<std::string> words_for(const FalconSettings& settings, const RuntimeSettings& runtime) {
    return {kFalconGuardian, settings.serial, settings.firmware, settings.firmware_sha256,
            std::to_string(runtime.realtime_scheduling ? runtime.priority : 0)};
}

// Sends a command without force. Empty once the Falcon has answered it; else why it has not. A chip that refuses
// settings still gets the command, because it mostly has them already.
std::string try_to_take_force_away(const std::string& serial) {
    try {
        const ClaimedFalcon falcon = claim_falcon(serial);
        const bool set = set_falcon_running(*falcon.link);
        falcon.link->write(encode(FalconCommand{}));
        return set && falcon_answers(*falcon.link) ? "" : "it does not answer";
    } catch (const Error& error) {
        return error.what();
    }
}

std::string take_force_away(const std::string& serial) {
    std::string failed = try_to_take_force_away(serial);
    for (const SessionTime end = wall_now() + kTakeLimit; !failed.empty() && wall_now() < end;) {
        wall_sleep(kTakeAgain);
        failed = try_to_take_force_away(serial);
    }
    return failed;
}

void make_ready(FalconLink& link, const FalconSettings& settings) {
    if (!set_falcon_running(link))
        throw Error(ExitCode::kRunFailed, "the Falcon's USB chip does not respond: " + link.last_error());
    if (falcon_answers(link)) return;
    if (settings.firmware.empty()) {
        throw Error(ExitCode::kUsage,
                    "the Falcon has lost its firmware, which it keeps only while it has power: name Novint's "
                    "file in [handle.falcon] firmware (docs/handles.md)");
    }
    const auto image = read_falcon_firmware(settings.firmware, settings.firmware_sha256);
    spdlog::info("loading the Falcon's firmware, {} bytes", image.size());
    load_falcon_firmware(link, image);
}

void say(FalconPage& page, FalconPage::State state, std::string_view text) {
    const std::size_t length = std::min(text.size(), page.text.size() - 1);
    std::copy_n(text.begin(), length, page.text.begin());
    page.state.store(state, std::memory_order_release);
}

// The terminal's signals are for the master. The guardian follows it within a turn.
void outlive_signals() {
    for (const int number : {SIGINT, SIGTERM, SIGQUIT, SIGHUP, SIGPIPE, SIGTSTP, SIGTTIN, SIGTTOU})
        std::signal(number, SIG_IGN);
}

void guard(FalconPage& page, const FalconSettings& settings, const RuntimeSettings& runtime) {
    const ClaimedFalcon falcon = claim_falcon(settings.serial);
    make_ready(*falcon.link, settings);
    ask_for_realtime(runtime);  // the master has the same settings, and says what the machine refuses
    FalconExchange exchange(*falcon.link, page.mailbox);
    exchange.turn();  // its first report decides whether it is homed
    say(page, FalconPage::State::kReady, falcon.serial);
    while (getppid() == page.master && !page.mailbox.asked_to_end() && exchange.turn()) {
    }
}

}  // namespace

FalconPageMemory::FalconPageMemory() : file_(memfd_create("falcon", MFD_CLOEXEC)), page_(nullptr) {
    if (file_.get() < 0 || ftruncate(file_.get(), sizeof(FalconPage)) != 0) {
        throw Error(ExitCode::kRunFailed, "no shared memory for the Falcon's guardian process: {}{}",
                    std::strerror(errno), descriptor_advice(errno));
    }
    page_ = new (map()) FalconPage;
    page_->master = getpid();
}

FalconPageMemory::FalconPageMemory(int descriptor)
    : file_(descriptor), page_(static_cast<FalconPage*>(map())) {}

FalconPageMemory::~FalconPageMemory() { munmap(page_, sizeof *page_); }

void* FalconPageMemory::map() {
    struct stat file {};
    const bool whole = fstat(file_.get(), &file) == 0 && file.st_size == sizeof(FalconPage);
    void* const memory =
        mmap(nullptr, sizeof(FalconPage), PROT_READ | PROT_WRITE, MAP_SHARED, file_.get(), 0);
    if (!whole || memory == MAP_FAILED)
        throw Error(ExitCode::kUsage,
                    "standard input is not a master: thimble-master starts this program itself");
    return memory;
}

FalconGuardian::FalconGuardian(const FalconSettings& settings, const RuntimeSettings& runtime,
                               const std::string& program)
    : child_(program, words_for(settings, runtime), "/dev/null",
             {memory_.descriptor(), STDERR_FILENO, STDERR_FILENO}) {
    await_ready();
    watch_ = std::thread([this] { watch(); });
}

FalconGuardian::~FalconGuardian() {
    mailbox().ask_to_end();
    if (watch_.joinable()) watch_.join();
}

void FalconGuardian::await_ready() {
    const FalconPage& page = memory_.page();
    while (page.state.load(std::memory_order_acquire) == FalconPage::State::kPreparing) {
        if (stop_requested()) throw Error(ExitCode::kRunFailed, "interrupted while the Falcon was starting");
        const auto ended = child_.poll();
        if (ended && page.state.load(std::memory_order_acquire) == FalconPage::State::kPreparing)
            throw Error(ExitCode::kRunFailed, "the Falcon's guardian ended with code {} before it was ready",
                        *ended);
        wall_sleep(milliseconds{1});
    }
    if (page.state.load(std::memory_order_acquire) == FalconPage::State::kFailed)
        throw Error(page.code, std::string(page.text.data()));
    serial_ = page.text.data();
}

// A guardian that stands still may never continue, with a force left at the device.
void FalconGuardian::watch() {
    FalconMailbox& box = mailbox();
    std::uint32_t turns = box.turns();
    for (int still = 0; !child_.poll(); wall_sleep(kLook)) {
        still = box.turns() == turns ? still + 1 : 0;
        turns = box.turns();
        if (still >= kLooksWithoutTurn) child_.signal(SIGKILL);
    }
    if (box.asked_to_end() && child_.poll() == 0 && !box.lost()) return;
    box.lose(FalconLoss::kGuardianEnded);
    const bool unplugged = box.loss() == FalconLoss::kUnplugged;
    const std::string_view event =
        unplugged ? "the Falcon's USB has failed" : "the Falcon's guardian process has ended";
    const std::string failed = take_force_away(serial_);
    if (failed.empty()) {
        spdlog::error("{}; the motors have no force now", event);
    } else if (unplugged && falcon_is_absent()) {
        spdlog::warn(
            "the Falcon has left the USB. If it still has power, its motors may hold a force: switch it off");
    } else {
        spdlog::critical("{}, and the motors may hold a force: switch the Falcon off ({})", event, failed);
    }
}

namespace {

int guard_falcon(std::span<char* const> words) {
    if (words.size() != kWords)
        throw Error(ExitCode::kUsage, "unknown option {}: thimble-master starts this program itself",
                    kFalconGuardian);
    FalconPageMemory memory(STDIN_FILENO);
    FalconSettings settings;
    settings.serial = words[2];
    settings.firmware = words[3];
    settings.firmware_sha256 = words[4];
    RuntimeSettings runtime;
    runtime.priority = std::atoi(words[5]);  // NOLINT(cert-err34-c): the master wrote it
    runtime.realtime_scheduling = runtime.priority > 0;
    try {
        guard(memory.page(), settings, runtime);
        return static_cast<int>(ExitCode::kOk);
    } catch (const Error& error) {  // the master reports it
        memory.page().code = error.code();
        say(memory.page(), FalconPage::State::kFailed, error.what());
        return static_cast<int>(error.code());
    }
}

}  // namespace

std::optional<int> run_falcon_guardian(int argc, char** argv) {
    const std::span<char* const> words(argv, static_cast<std::size_t>(argc));
    if (argc < 2 || std::string_view(words[1]) != kFalconGuardian) return std::nullopt;
    outlive_signals();
    prctl(PR_SET_NAME, "falcon-guardian", 0UL, 0UL, 0UL);
    return guarded_main("falcon-guardian", [&] { return guard_falcon(words); });
}

}  // namespace thimble
