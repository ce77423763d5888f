// thimble run --step: a session in lock-step pauses between two instants, says what is due next, and asks how far to go.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "session/participant/prompt.hpp"
#include "session/virtual/stepped_condition.hpp"

namespace thimble {

enum class StepKind : std::uint8_t {
    kNext,   // an empty line: one instant
    kFor,    // a duration: at least so long
    kToEnd,  // c: of the run
    kQuit,   // q
    kUnknown,
};

struct StepRequest {
    StepKind kind = StepKind::kUnknown;
    Duration duration{};
};

inline constexpr const char* kStepHelp =
    "Enter: next event; 50ms or 0.05: run that long; c: run to the end; q: quit";

StepRequest parse_step(std::string_view line);

// A pause as text: when it is, needle and force, and for each program its pid and its next wake-up.
std::string pause_text(SteppedSession& session);

// Of a whole run, in all its trials.
class StepPrompt : boost::noncopyable {
  public:
    using Say = std::function<void(const std::string&)>;
    StepPrompt(std::unique_ptr<LineSource> lines, Say say) : lines_(std::move(lines)), say_(std::move(say)) {}

    // A trial begins: it pauses before its first instant.
    void begin_trial() {
        if (pause_at_ != kNever) pause_at_ = SessionTime::min();
    }
    // Returns when the next instant may come. After the last line nothing pauses any more.
    void before_instant(SteppedSession& session);

  private:
    std::optional<StepRequest> ask();
    void obey(const StepRequest& request, SessionTime now);

    std::unique_ptr<LineSource> lines_;
    Say say_;
    SessionTime pause_at_ = SessionTime::min();
};

// Another session, which pauses.
class PausedSession final : public SteppedSession {
  public:
    // `prompt` outlives this.
    PausedSession(std::unique_ptr<SteppedSession> session, StepPrompt& prompt)
        : session_(std::move(session)), prompt_(prompt) {}

    SessionProcess& session() override { return session_->session(); }
    void start(const TrialConditions& conditions) override {
        session_->start(conditions);
        prompt_.begin_trial();
    }
    bool step() override {
        if (!session().finished() && !lost()) prompt_.before_instant(*session_);
        return session_->step();
    }
    SessionTime now() const override { return session_->now(); }
    const std::optional<LostNode>& lost() const override { return session_->lost(); }
    std::vector<DueProgram> due() const override { return session_->due(); }
    std::string fault() const override { return session_->fault(); }
    void look_outside() override { session_->look_outside(); }

  private:
    std::unique_ptr<SteppedSession> session_;
    StepPrompt& prompt_;
};

}  // namespace thimble
