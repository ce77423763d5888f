// The process that has the Falcon. A Falcon keeps its last force when no program sends to it, and it has no watchdog. So the master never
// opens the device: it starts this process, which exchanges packets with it and shares a FalconMailbox with the master.
//
// - Master killed or stopped: no command renews the force, so the exchange sends none after 20 turns, some 20 to 40 ms. The guardian of a
//   master that has ended does the same and ends.
// - Guardian killed or stopped: the master notices within 0.3 s. It kills what is stopped, claims the device and sends commands without
//   force.
#pragma once

#include <array>
#include <atomic>
#include <optional>
#include <string>
#include <sys/types.h>
#include <thread>

#include <boost/core/noncopyable.hpp>

#include "common/process/child.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "master/devices/falcon/falcon_mailbox.hpp"
#include "master/devices/handle_settings.hpp"

namespace thimble {

// The first word of a command line that asks for the guardian. It is no option of a user.
inline constexpr const char* kFalconGuardian = "--falcon-guardian";

// The memory that both processes share.
struct FalconPage {
    enum class State : std::uint8_t { kPreparing, kReady, kFailed };
    FalconMailbox mailbox;
    pid_t master = 0;
    // Written before `state`: the serial number, or why the guardian failed.
    std::array<char, 2048> text{};
    ExitCode code = ExitCode::kOk;
    std::atomic<State> state{State::kPreparing};
};

// A page that begins in this process and goes to the guardian as its standard input.
class FalconPageMemory : boost::noncopyable {
  public:
    FalconPageMemory();
    explicit FalconPageMemory(int descriptor);  // of another process's page; throws Error (usage)
    ~FalconPageMemory();
    FalconPage& page() { return *page_; }
    int descriptor() const { return file_.get(); }

  private:
    void* map();

    FileDescriptor file_;
    FalconPage* page_;
};

class FalconGuardian : boost::noncopyable {
  public:
    // Starts `program`, which calls run_falcon_guardian(), and waits until the device is ready. Throws the guardian's Error.
    FalconGuardian(const FalconSettings& settings, const RuntimeSettings& runtime,
                   const std::string& program);
    ~FalconGuardian();

    FalconMailbox& mailbox() { return memory_.page().mailbox; }
    const std::string& serial() const { return serial_; }
    pid_t pid() const { return child_.pid(); }

  private:
    void await_ready();
    void watch();

    FalconPageMemory memory_;
    Child child_;
    std::string serial_;
    std::thread watch_;
};

// The guardian's own process. It holds the device until the master ends or asks it to end. Returns an exit code; nothing if argv does not
// begin with kFalconGuardian.
std::optional<int> run_falcon_guardian(int argc, char** argv);

}  // namespace thimble
