// Asks a participant questions at the screen, one after another, and waits for the answers.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "session/participant/agenda.hpp"
#include "session/participant/phenotype.hpp"
#include "session/participant/prompt.hpp"

namespace thimble {

class TrialRunner;

enum class Asked {
    kGoOn,
    kLeftOut,
    kStopped,
    kPutOff,  // a trial of the block is to be run again first
};

// Everything that a question needs; all of it outlives the asking.
struct Asker {
    TrialRunner& runner;
    LineSource* lines;  // the experimenter leaves a question out or stops; null: no experimenter
    const std::atomic<bool>* stop;
    const std::function<void(const std::string&)>& say;
    std::function<Asked(const std::string& line)> obey{};  // any other command; kGoOn: the question goes on
    std::function<Asked()> hold{};  // waits while an emergency stop holds; kGoOn: the question goes on
};

// `number` as in PageSet::shown(). `value` gets the answer.
Asked ask_question(const Asker& asker, const PageSet& pages, std::uint32_t number, double& value);

// Reports an emergency stop, shows `paused`, and waits for the release. kGoOn: no stop is active.
Asked await_release(const Asker& asker, Page paused);

// kStopped, kPutOff: no answer is to be kept, and the questionnaire comes again. kGoOn: `answers` gets one per question, none where
// it was left out.
Asked ask_questionnaire(const Asker& asker, const PageSet& pages, std::size_t questionnaire,
                        std::vector<std::optional<double>>& answers);

enum class Consent { kGiven, kDeclined, kStopped };
// The pages have a consent page.
Consent ask_consent(const Asker& asker, const PageSet& pages);

// Which questionnaire is to be answered before this step; nothing for `step`: after the last trial. `block` gets the block that it is
// about.
std::optional<std::size_t> due_questionnaire(const Dataset& dataset, const PageSet& pages,
                                             const Agenda& agenda, const std::optional<Step>& step,
                                             std::uint32_t& block);

}  // namespace thimble
