#include "session/settings/protocol_settings.hpp"

#include <algorithm>
#include <cmath>

#include "session/settings/protocol.hpp"
#include "visual_node/visual_settings.hpp"

namespace thimble {
namespace {

std::vector<std::uint32_t> read_experiments(const ConfigTable& table) {
    std::vector<double> numbers{3};
    table.read(
        "experiments", numbers, 1, 3,
        "Experiments of the paper: [1], [2] or [1, 2] without delay, or [3] at the delays of [session].");
    std::vector<std::uint32_t> experiments;
    for (const double number : numbers) {
        experiments.push_back(static_cast<std::uint32_t>(number));
        if (number != std::floor(number)) experiments.clear();
    }
    const std::vector<std::vector<std::uint32_t>> allowed{{1}, {2}, {1, 2}, {3}};
    if (std::find(allowed.begin(), allowed.end(), experiments) == allowed.end()) {
        table.fail("experiments",
                   "must be [1], [2], [1, 2] or [3]: 1 and 2 have no delay and 3 has one; write a session "
                   "file with a folder of its own for other people or another day");
    }
    return experiments;
}

}  // namespace

ProtocolSettings read_protocol_settings(const ConfigTable& table) {
    ProtocolSettings p;
    p.experiments = read_experiments(table);
    p.subjects = p.experiments == std::vector{3U} ? kSubjectsWithDelay : kSubjectsWithoutDelay;
    table.read("subjects", p.subjects, 1, 1'000'000,
               "Planned number of participants: P01 to P10. Default without experiment 3: 16. Removals are "
               "balanced over them.");
    table.read("trials_per_modality", p.trials_per_modality, 1, 100,
               "Trials of each participant in each modality.");
    table.read("removals", p.removals, 1, 100,
               "Experiment 2: number of trials per participant in which the fixture vanishes.");
    table.read("practice_trials", p.practice_trials, 0, 1000,
               "Practice trials before all others, each modality in turn; never analysed.");
    table.read("break_every", p.break_every, 0, 1000,
               "Trials between two breaks (a block); there is a break after practice as well; 0: no breaks.");
    p.break_text = read_break_text(table);
    table.read("break_minimum_s", p.break_minimum, 0, 3600,
               "Shortest break; Enter ends it after that. A virtual subject does not rest.");
    table.read("repeat", p.repeat, {"end_of_block", "at_once"},
               "Time at which a failed or rejected trial is repeated.");
    table.read("repeats_limit", p.repeats_limit, 0, 100,
               "Most repeats of a trial that timed out or lost a program; repeats on command have no limit.");
    table.read("repeat_timeouts", p.repeat_timeouts, "false: a timeout is a result and is not repeated.");
    table.read("attention_every", p.attention_every, 0, 1000,
               "Trials between two attention trials, which the analysis leaves out; 0: no attention trials.");
    table.read("attention_limit_s", p.attention_limit, 1, 3600,
               "An attention trial is passed if the beep comes within this time.");
    table.read("blinded", p.blinded,
               "The experimenter's terminal shows neither modality, delay nor result of a trial.");
    p.subject_goes_on = read_subject_goes_on(table);
    return p;
}

DatasetSettings read_dataset_settings(const ConfigTable& table) {
    DatasetSettings d;
    table.read("name", d.name, "Name of the dataset, in dataset_description.json.");
    if (d.name.empty()) table.fail("name", "is empty; a dataset needs a name");
    table.read("license", d.license, "Licence of the dataset, for example \"CC0\".");
    table.read("authors", d.authors, "Names of the authors.");
    table.read("ethics_approvals", d.ethics_approvals, "Numbers of the ethics approvals.");
    return d;
}

}  // namespace thimble
