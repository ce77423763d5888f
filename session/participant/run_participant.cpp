#include "session/participant/run_participant.hpp"

#include <algorithm>
#include <unistd.h>

#include <fmt/format.h>

#include "common/error.hpp"
#include "session/participant/questions.hpp"
#include "session/participant/real_trials.hpp"
#include "session/participant/tsv.hpp"

namespace thimble {
namespace {

// Starts the nodes for a person: thimble-visual gets a window, whatever [visual] display says.
class PersonStarter final : public NodeStarter {
  public:
    explicit PersonStarter(std::shared_ptr<NodeStarter> starter) : starter_(std::move(starter)) {}

    std::shared_ptr<RunningNode> start(const NodeOrder& order) const override {
        NodeOrder mine = order;
        if (order.role == Role::kVisual) mine.arguments.emplace_back("--window");
        return starter_->start(mine);
    }
    Duration reach() const override { return starter_->reach(); }
    std::string machine(Role role) const override { return starter_->machine(role); }

  private:
    std::shared_ptr<NodeStarter> starter_;
};

std::uint32_t participant_of(const SystemSettings& settings, const std::string& said) {
    const auto participant = said.empty() ? settings.plan.subject : parse_participant(said).value_or(0);
    if (participant != 0) return participant;
    throw Error(ExitCode::kUsage,
                said.empty()
                    ? "the participant's number is missing: give --participant P07, or set [session] "
                      "participant = \"P07\""
                    : fmt::format("--participant {}: write P and a number, e.g. P07; never a name", said));
}

void check_person(const SystemSettings& settings, const ParticipantRun& run) {
    if (run.starter && settings.handle.kind == HandleKind::kSimulated) {
        throw Error(
            ExitCode::kUsage,
            "a virtual operator holds the simulated handle, but this session is for a person: set [handle] "
            "device to \"pointer\" (mouse), \"keyboard\", \"hid\" (SpaceMouse or gamepad), or a "
            "force-feedback device: \"force-dimension\", \"falcon\", \"haply\", \"touch\" or \"ros2\" "
            "(docs/handles.md). If a thimble-master with such a handle runs already, give --attach");
    }
    if (!run.person.consent && !settings.pages.consent) {
        throw Error(ExitCode::kUsage,
                    "a person takes part only with informed consent: if the person has given it, add "
                    "--consent; or use pages with a consent page, [instructions] pages = \"en.toml\"");
    }
}

// Nodes that run already have the delay of their own file, which is to be this one. A blinded experimenter learns no delay.
void check_delay(const SystemSettings& settings, const std::vector<OrderEntry>& order, bool attach) {
    const double delay_s = order.front().conditions.delay_s;
    const bool blinded = settings.protocol->blinded;
    for (const OrderEntry& entry : order) {
        if (entry.conditions.delay_s == delay_s) continue;
        if (blinded)
            throw Error(ExitCode::kData,
                        "the order of trials has two delays, but a participant session has one");
        throw Error(ExitCode::kData,
                    "the order of trials has two delays, {} s and {} s, but a participant session has one",
                    delay_s, entry.conditions.delay_s);
    }
    const double theirs_s = to_seconds(settings.netem.force.delay);
    if (!attach || theirs_s == delay_s) return;
    if (blinded)
        throw Error(ExitCode::kUsage,
                    "[netem.force] delay_s is not the delay of the order of trials. The session is blinded, "
                    "so this message does not name it. Ask somebody who may know it to compare the order's "
                    "delay_s with this file and with that of the running thimble-netem");
    throw Error(ExitCode::kUsage,
                "experiment {} delays the force by {} s, but [netem.force] delay_s is {}: set it in this "
                "file and in the file of the running thimble-netem, then restart thimble-netem",
                order.front().conditions.experiment, delay_s, theirs_s);
}

// Describes how the settings' order differs from the written one; empty if it does not.
std::string what_differs(const SystemSettings& settings, std::uint32_t participant,
                         const std::vector<OrderEntry>& written) {
    try {
        return difference(written, plan_order(settings, participant), settings.protocol->blinded);
    } catch (const Error& no_longer_planned) {
        if (settings.protocol->blinded) return "the settings give none";
        return no_longer_planned.what();
    }
}

bool has_begun(const Dataset& dataset, std::uint32_t participant) {
    std::error_code none;
    return knows_person(dataset, participant) || !read_records(dataset.records(participant)).empty() ||
           std::filesystem::exists(dataset.source(participant) / "trajectories", none);
}

// The written one wins over what the settings would give now: the participant has begun with it, and cannot
// begin anew.
std::vector<OrderEntry> order_of(const SystemSettings& settings, const Dataset& dataset,
                                 std::uint32_t participant, bool resume, bool& written) {
    const auto file = dataset.order(participant);
    // A start that failed has left an order, and nothing of a person: the participant begins with a new order.
    if (!is_table(file) || (!resume && !has_begun(dataset, participant))) {
        if (!resume) return plan_order(settings, participant);
        throw Error(ExitCode::kUsage,
                    "{} has no order of trials in {}: check the number and the folder, or leave out --resume",
                    participant_id(participant), dataset.folder().string());
    }
    std::vector<OrderEntry> order = read_order(file, participant);
    if (order.empty()) throw Error(ExitCode::kData, "{}: has no trials", file.string());
    if (!resume) {
        throw Error(ExitCode::kUsage, "{} has already begun: continue with --resume, or check the number",
                    participant_id(participant));
    }
    written = true;
    return order;
}

ConditionPlan condition_plan(const SystemSettings& settings, const ParticipantRun& run,
                             const Dataset& dataset, std::uint32_t participant, double delay_s) {
    ConditionPlan plan;
    const bool human = settings.plan.kind == SubjectKind::kHuman;
    plan.starter = human && run.starter ? std::make_shared<PersonStarter>(run.starter) : run.starter;
    plan.out = dataset.source(participant) / "nodes";
    plan.network = run.network;
    plan.session = session_settings(with_force_delay(settings, from_seconds(delay_s)));
    plan.session.ends_by_withdrawal = human;
    plan.session.subject_goes_on = human && settings.protocol->subject_goes_on;
    plan.delay_s = delay_s;
    plan.runtime = settings.runtime;
    plan.strict_rt = run.strict_rt;
    plan.log = settings.log;
    plan.session_file = settings.file;
    if (run.view) plan.make_observer = run.view->make_observer;
    if (run.make_observer) plan.make_observer = run.make_observer;
    return plan;
}

bool experimenter_answers(const SystemSettings& settings, const ParticipantRun& run) {
    return run.commands || (settings.plan.kind == SubjectKind::kHuman && isatty(STDIN_FILENO) == 1);
}

// On the screen, where the page set has a consent page that this participant has not agreed to in this version.
Consent consent_of(const SystemSettings& settings, const ParticipantRun& run, const Dataset& dataset,
                   std::uint32_t participant, std::size_t planned, RealTrials& trials, LineSource* answers) {
    const auto& page = settings.pages.consent;
    if (!page || settings.plan.kind != SubjectKind::kHuman) return Consent::kGiven;
    if (has_consented(dataset, *page, participant)) return Consent::kGiven;
    trials.prepare();
    const std::function<void(const std::string&)> say = [&trials](const std::string& line) {
        trials.say(line);
    };
    LineSource* const lines = answers == nullptr && run.view ? run.view->lines : answers;
    Asker asker{trials, lines, run.stop, say};
    Page paused;
    paused.trial = 1;
    paused.trials = static_cast<std::uint32_t>(planned);
    asker.hold = [&asker, &paused] { return await_release(asker, paused); };
    return ask_consent(asker, settings.pages);
}

// Without consent nothing of the person is kept, but for what the person consented to before.
ParticipantSessionResult end_without_consent(const Dataset& dataset, std::uint32_t participant,
                                             Consent consent, RealTrials& trials) {
    Page done;
    done.kind = PageKind::kDone;
    trials.show(done);
    trials.idle(std::chrono::seconds{1});
    trials.close();
    const bool begun = has_begun(dataset, participant);  // perhaps by another session, during the question
    if (!begun) std::filesystem::remove_all(dataset.source(participant));
    ParticipantSessionResult result;
    result.participant = participant;
    result.declined = consent == Consent::kDeclined;
    result.kept = begun;
    if (result.declined) return result;
    result.code = ExitCode::kRunFailed;
    result.problem = begun ? fmt::format(
                                 "interrupted before the participant consented; no further trial was run, "
                                 "and earlier data are kept in {}",
                                 dataset.folder().string())
                           : "interrupted before the participant consented; no data are kept";
    return result;
}

ParticipantSessionResult run_to_end(const SystemSettings& settings, const ParticipantRun& run,
                                    const Dataset& dataset, std::uint32_t participant, RealTrials& trials,
                                    LineSource* answers) {
    const bool human = settings.plan.kind == SubjectKind::kHuman;
    ParticipantSessionOptions options{dataset,
                                      participant,
                                      *settings.protocol,
                                      answers,
                                      human,
                                      run.stop,
                                      [&trials](const std::string& line) { trials.say(line); }};
    if (run.view) {
        options.requests = run.view->lines;
        options.paused = run.view->paused;
    }
    options.subject_goes_on = human && settings.protocol->subject_goes_on;
    if (human) options.pages = &settings.pages;
    options.realtime_ns = [] { return read_clock_pair().realtime_ns; };
    return ParticipantSession(std::move(options), trials).run();
}

}  // namespace

void check_virtual_subject(const SystemSettings& settings) {
    if (settings.plan.kind == SubjectKind::kHuman || settings.handle.kind == HandleKind::kSimulated) return;
    throw Error(ExitCode::kUsage,
                "a virtual subject holds only the simulated handle, but [handle] device names another one: "
                "remove it, or set [session] subject = \"human\"");
}

ParticipantSessionResult run_participant(const SystemSettings& settings, const ParticipantRun& run) {
    const SubjectKind kind = settings.plan.kind;
    const std::uint32_t participant = participant_of(settings, run.participant);
    if (kind == SubjectKind::kHuman) check_person(settings, run);
    if (run.starter) check_virtual_subject(settings);
    const Dataset dataset(run.out);
    if (const auto found = dataset.kind(); found && *found != kind) dataset.open(kind, settings.dataset);
    bool written = false;
    const auto order = order_of(settings, dataset, participant, run.resume, written);
    check_delay(settings, order, run.starter == nullptr);
    if (kind == SubjectKind::kHuman) check_phenotype(dataset, settings.pages, order.back().block);
    if (run.check_screen) run.check_screen();

    dataset.open(kind, settings.dataset);
    if (run.view) run.view->planned(order.size());
    RealTrials trials(condition_plan(settings, run, dataset, participant, order.front().conditions.delay_s),
                      run.stop, settings.protocol->blinded);
    DescriptorLines typed(STDIN_FILENO);
    TwoLineSources both(typed, run.view ? *run.view->lines : typed);
    LineSource* const answers = experimenter_answers(settings, run) ? &both : nullptr;
    const Consent consent = consent_of(settings, run, dataset, participant, order.size(), trials, answers);
    if (consent != Consent::kGiven) return end_without_consent(dataset, participant, consent, trials);
    // The order first: an analysis asks for the order of every participant that is in the table.
    if (!written) write_order(dataset.order(participant), order);
    PersonDescription person = run.person;
    person.consent = true;
    const std::string line = add_participant(dataset, participant, kind, person);
    if (settings.pages.consent && kind == SubjectKind::kHuman &&
        !has_consented(dataset, *settings.pages.consent, participant))
        write_consent(dataset, *settings.pages.consent, participant, utc_text(read_clock_pair().realtime_ns));
    if (!line.empty())
        trials.say(fmt::format("participants.tsv already has other values and keeps them: {}", line));
    const std::string other = written ? what_differs(settings, participant, order) : "";
    if (!other.empty()) {
        trials.say(
            fmt::format("warning: the order of trials in {} differs from the order of this session file: {}. "
                        "The one in the folder is used",
                        dataset.order(participant).string(), other));
    }
    ParticipantSessionResult result = run_to_end(settings, run, dataset, participant, trials, answers);
    const ConditionResult closed = trials.close();
    // The session has printed the problem of the last trial.
    const bool new_fault = closed.code == ExitCode::kRunFailed && closed.problem != trials.problem();
    if (result.code == ExitCode::kOk && (closed.code == ExitCode::kRealtime || new_fault)) {
        result.code = closed.code;
        result.problem = closed.problem;
    }
    return result;
}

}  // namespace thimble
