// One participant's session: trial after trial as the agenda says, breaks, what the experimenter types, every
// line on the disk before the next trial begins. It knows files and a TrialRunner, no network and no clock.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include <boost/core/noncopyable.hpp>

#include "common/error.hpp"
#include "session/participant/agenda.hpp"
#include "session/participant/dataset.hpp"
#include "session/participant/phenotype.hpp"
#include "session/participant/prompt.hpp"
#include "session/participant/questions.hpp"
#include "session/records/trial_record.hpp"

namespace thimble {

// Where trials come from: the real programs, or virtual time in tests.
class TrialRunner : boost::noncopyable {
  public:
    virtual ~TrialRunner() = default;

    // All nodes are there when it returns, started anew if one was lost. Throws Error (network) if not.
    virtual void prepare() = 0;
    // The greatest number of a trial that a node has seen.
    virtual std::uint32_t last_number() const = 0;
    virtual TrialRecord run(const TrialConditions& conditions, std::uint32_t number,
                            const std::filesystem::path& trajectory) = 0;
    // The page on the participant's screen until the next trial.
    virtual void show(const Page& page) = 0;
    // Whether the participant has asked to go on from that page since the last call.
    virtual bool take_go_on() = 0;
    // The participant's answer to the question on that page, given since the last call.
    virtual std::optional<double> take_answer() { return std::nullopt; }
    // Lets time pass between trials.
    virtual void idle(Duration limit) = 0;
    virtual SessionTime now() const = 0;
    // Why the last peer was lost.
    virtual std::string problem() const = 0;
    // Of a stop: its source and how to release it. Empty: no stop holds.
    virtual std::string stop_text() const { return {}; }
    virtual void release_stop() {}
};

struct ParticipantSessionOptions {
    Dataset dataset;
    std::uint32_t participant = 1;
    ProtocolSettings protocol;
    LineSource* lines = nullptr;  // where the experimenter answers; null: no experimenter
    bool rests = true;            // breaks last at least their minimum
    const std::atomic<bool>* stop = nullptr;
    std::function<void(const std::string&)> say;
    // Without an experimenter at the keyboard, a view may send the same lines, and a pause before the next trial.
    LineSource* requests = nullptr;
    std::function<bool()> paused{};
    // The participant, too, may begin the next trial; with no experimenter asked, the participant alone.
    bool subject_goes_on = false;
    const PageSet* pages = nullptr;               // whose questionnaires a person answers; null: none
    std::function<std::int64_t()> realtime_ns{};  // since 1970, when they were; none: not recorded
};

struct ParticipantSessionResult {
    ExitCode code = ExitCode::kOk;
    std::string problem;  // why it ended early; empty if the participant session is complete
    std::uint32_t participant = 0;
    std::size_t trials_begun = 0, trials_planned = 0;
    std::size_t records = 0, repeats = 0;
    bool declined = false;  // the participant did not consent, and no further trial was run
    bool kept = false;      // without consent: what was recorded before is still there
};

class ParticipantSession {
  public:
    // Reads what is there; the order must be. `runner` outlives the participant session.
    ParticipantSession(ParticipantSessionOptions options, TrialRunner& runner);
    ParticipantSessionResult run();

  private:
    enum class Answer { kGo, kAskAgain, kStop };

    Asker asker(const std::optional<Step>& step);
    Answer await_release(const std::optional<Step>& step);
    Answer before(const std::optional<Step>& step);
    Answer ask_questions(const std::optional<Step>& step);
    Asked after_order(Answer answer) const;
    bool questions_are_due(const std::optional<Step>& step) const;
    Answer ask(const std::string& prompt, const std::optional<Step>& step);
    Page page(const std::optional<Step>& step) const;
    void wait(const std::optional<Step>& step);
    std::optional<Answer> take_requests(const std::optional<Step>& step);
    std::string who_goes_on(const std::optional<Step>& step) const;
    // Null: no experimenter sends commands.
    LineSource* commands() const { return options_.lines != nullptr ? options_.lines : options_.requests; }
    std::optional<std::string> take_line();
    bool paused() const { return options_.paused && options_.paused(); }
    Answer obey(const std::string& line);
    Answer go_on();
    void mark_last(ExclusionKind kind, const std::string& reason);
    void do_trial(const Step& step);
    bool rest_is_due(const std::optional<Step>& step) const;
    std::string name_of(const Step& step) const;
    void note_attention(const DatasetRecord& record);
    void note_missed_attention();
    std::string course_of(const DatasetRecord& record) const;
    bool stopped() const { return options_.stop != nullptr && *options_.stop; }
    ParticipantSessionResult result(ExitCode code, std::string problem) const;

    ParticipantSessionOptions options_;
    TrialRunner& runner_;
    Agenda agenda_;
    RecordTable table_;
    std::optional<std::uint32_t> last_block_;  // of the last trial since this program started
    std::optional<Rest> rest_;
    std::uint32_t last_number_ = 0;
    unsigned lost_in_a_row_ = 0;
};

}  // namespace thimble
