#include "session/settings/protocol_settings.hpp"

#include <algorithm>
#include <cmath>

#include "session/settings/protocol.hpp"
#include "visual_node/visual_settings.hpp"

namespace thimble {
namespace {

std::vector<std::uint32_t> read_experiments(const ConfigTable& table) {
    std::vector<double> numbers{3};
    table.read("experiments", numbers, 1, 3,
               "[1], [2] or [1, 2], without delay, or [3], at the delays of [session].");
    std::vector<std::uint32_t> experiments;
    for (const double number : numbers) {
        experiments.push_back(static_cast<std::uint32_t>(number));
        if (number != std::floor(number)) experiments.clear();
    }
    const std::vector<std::vector<std::uint32_t>> allowed{{1}, {2}, {1, 2}, {3}};
    if (std::find(allowed.begin(), allowed.end(), experiments) == allowed.end()) {
        table.fail("experiments",
                   "must be [1], [2], [1, 2] or [3]: 1 and 2 are without delay and 3 is with; give other "
                   "people, or another day, a file and a folder of their own");
    }
    return experiments;
}

}  // namespace

ProtocolSettings read_protocol_settings(const ConfigTable& table) {
    ProtocolSettings p;
    p.experiments = read_experiments(table);
    p.subjects = p.experiments == std::vector{3U} ? kSubjectsWithDelay : kSubjectsWithoutDelay;
    table.read(
        "subjects", p.subjects, 1, 1'000'000,
        "Planned: P01 to P10. Without experiment 3 the default is 16. Removals are balanced over them.");
    table.read("trials_per_modality", p.trials_per_modality, 1, 100, "Of each participant.");
    table.read("removals", p.removals, 1, 100,
               "Experiment 2: trials with the fixture's removal, per participant.");
    table.read("practice_trials", p.practice_trials, 0, 1000,
               "Before all others, each modality in turn; never analysed.");
    table.read("break_every", p.break_every, 0, 1000,
               "Trials between two breaks (a block); there is one after practice, too; 0: no breaks.");
    table.read("break_text", p.break_text, "The text on the screen in a break.");
    table.read("break_minimum_s", p.break_minimum, 0, 3600,
               "Enter ends a break, but not before; a virtual subject does not rest.");
    table.read("repeat", p.repeat, {"end_of_block", "at_once"},
               "When a failed or rejected trial is run again.");
    table.read("repeats_limit", p.repeats_limit, 0, 100,
               "How often a trial that timed out or lost a node is repeated; by command without limit.");
    table.read("repeat_timeouts", p.repeat_timeouts, "false: a timeout is a result and stays.");
    table.read("attention_every", p.attention_every, 0, 1000,
               "After so many trials comes an attention trial, which the analysis leaves out; 0: none.");
    table.read("attention_limit_s", p.attention_limit, 1, 3600,
               "An attention trial is passed if the beep comes within this time.");
    table.read("blinded", p.blinded,
               "The experimenter's terminal names neither modality nor delay, and no result of a trial.");
    p.subject_goes_on = read_subject_goes_on(table);
    return p;
}

DatasetSettings read_dataset_settings(const ConfigTable& table) {
    DatasetSettings d;
    table.read("name", d.name, "Of the dataset, in dataset_description.json.");
    if (d.name.empty()) table.fail("name", "is empty; a dataset needs a name");
    table.read("license", d.license, "For example \"CC0\".");
    table.read("authors", d.authors, "Their names.");
    table.read("ethics_approvals", d.ethics_approvals, "Numbers of the approvals.");
    return d;
}

}  // namespace thimble
