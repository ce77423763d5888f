#include "session/participant/questions.hpp"

#include <fmt/format.h>

#include "session/participant/participant_session.hpp"

namespace thimble {
namespace {

constexpr Duration kAnswerLook = std::chrono::milliseconds{20};  // for an answer, a line, a stop
constexpr const char* kHelp =
    "the participant answers at the screen; s: skip this question; r REASON, x REASON: as between trials; q: "
    "quit";
constexpr const char* kConsentHelp = "the participant answers at the screen; q: quit";

// The experimenter has typed this; kGoOn: the question goes on.
Asked obey(const Asker& asker, const std::string& line) {
    if (line == "q") return Asked::kStopped;
    if (line == "s") return Asked::kLeftOut;
    if (asker.obey && !line.empty()) return asker.obey(line);
    asker.say(asker.obey ? kHelp : kConsentHelp);
    return Asked::kGoOn;
}

// The experimenter has typed this while a stop holds. kStopped: the session ends.
Asked obey_in_stop(const Asker& asker, const std::string& line) {
    if (line == "release") {
        asker.runner.release_stop();
    } else if (line.empty() || line == "s") {
        asker.say("release the stop before anything begins");
    } else {
        return obey(asker, line);
    }
    return Asked::kGoOn;
}

// A block's end: its last trial is over, and no repeat of it is left. A trial that is rejected meanwhile puts the questions off.
bool ends_block(const Agenda& agenda, const std::optional<Step>& step) {
    if (agenda.records.empty() || agenda.records.back().block == 0) return false;
    return !step || step->entry.block != agenda.records.back().block;
}

}  // namespace

Asked ask_question(const Asker& asker, const PageSet& pages, std::uint32_t number, double& value) {
    const Question question = pages.shown().at(number - 1).question;
    Page page;
    page.trials = pages.checksum();
    page.kind = PageKind::kQuestion;
    page.trial = number;
    for (;;) {
        asker.runner.show(page);
        asker.runner.idle(kAnswerLook);
        const Asked held = asker.hold ? asker.hold() : Asked::kGoOn;
        if (held != Asked::kGoOn) return held;
        if (asker.stop != nullptr && *asker.stop) return Asked::kStopped;
        const auto answer = asker.runner.take_answer();
        if (answer && question.accepts(*answer)) {
            value = *answer;
            return Asked::kGoOn;
        }
        const auto line = asker.lines == nullptr ? std::nullopt : asker.lines->take_line();
        const Asked obeyed = line ? obey(asker, *line) : Asked::kGoOn;
        if (obeyed != Asked::kGoOn) return obeyed;
        if (asker.lines != nullptr && asker.lines->ended()) {
            asker.say(kInputEnded);
            return Asked::kStopped;
        }
    }
}

Asked await_release(const Asker& asker, Page paused) {
    paused.kind = PageKind::kPaused;
    std::string said;
    for (std::string text = asker.runner.stop_text(); !text.empty(); text = asker.runner.stop_text()) {
        if (text != said) asker.say(text + ", or type 'release'");
        said = text;
        if (asker.stop != nullptr && *asker.stop) return Asked::kStopped;
        const auto line = asker.lines == nullptr ? std::nullopt : asker.lines->take_line();
        if (line && obey_in_stop(asker, *line) == Asked::kStopped) return Asked::kStopped;
        if (!line && asker.lines != nullptr && asker.lines->ended()) {
            asker.say(kInputEnded);
            return Asked::kStopped;
        }
        asker.runner.show(paused);
        asker.runner.idle(kAnswerLook);
    }
    if (!said.empty()) asker.say("released");
    return Asked::kGoOn;
}

Asked ask_questionnaire(const Asker& asker, const PageSet& pages, std::size_t questionnaire,
                        std::vector<std::optional<double>>& answers) {
    const Questionnaire& form = pages.questionnaires[questionnaire];
    asker.say(fmt::format("questionnaire {}, {} questions: {}", form.name, form.questions.size(), kHelp));
    answers.clear();
    answers.reserve(form.questions.size());
    const std::uint32_t first = pages.first_number(questionnaire);
    for (std::uint32_t i = 0; i < form.questions.size(); ++i) {
        double value = 0;
        const Asked asked = ask_question(asker, pages, first + i, value);
        if (asked == Asked::kPutOff)
            asker.say(fmt::format("questionnaire {} comes after the repeat, from its beginning", form.name));
        if (asked == Asked::kStopped || asked == Asked::kPutOff) return asked;
        answers.push_back(asked == Asked::kGoOn ? std::optional{value} : std::nullopt);
    }
    return Asked::kGoOn;
}

Consent ask_consent(const Asker& asker, const PageSet& pages) {
    asker.say(fmt::format("consent, version {}: {}", pages.consent->version, kConsentHelp));
    double answer = 0;
    for (;;) {
        const Asked asked = ask_question(asker, pages, 1, answer);
        if (asked == Asked::kStopped) return Consent::kStopped;
        if (asked == Asked::kLeftOut) continue;  // an experimenter cannot consent for a participant
        return answer == ConsentPage::kAgreed ? Consent::kGiven : Consent::kDeclined;
    }
}

std::optional<std::size_t> due_questionnaire(const Dataset& dataset, const PageSet& pages,
                                             const Agenda& agenda, const std::optional<Step>& step,
                                             std::uint32_t& block) {
    for (std::size_t i = 0; i < pages.questionnaires.size(); ++i) {
        const Questionnaire& form = pages.questionnaires[i];
        const bool starts = form.when == AskedWhen::kStart;
        const bool due = starts || (form.when == AskedWhen::kBlock ? ends_block(agenda, step) : !step);
        block = starts || agenda.records.empty() ? 0 : agenda.records.back().block;
        if (due && !is_filled(dataset, form, agenda.participant, block)) return i;
    }
    return std::nullopt;
}

}  // namespace thimble
