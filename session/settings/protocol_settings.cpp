#include "session/settings/protocol_settings.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "session/settings/protocol.hpp"
#include "visual_node/visual_settings.hpp"

namespace thimble {
namespace {

std::vector<std::uint32_t> read_experiments(const ConfigTable& table) {
    std::vector<std::uint32_t> experiments;
    for (const double number : table.numbers("experiments", {3}, 1, 3)) {
        experiments.push_back(static_cast<std::uint32_t>(number));
        if (number != std::floor(number)) experiments.clear();
    }
    const std::vector<std::vector<std::uint32_t>> allowed{{1}, {2}, {1, 2}, {3}};
    if (std::find(allowed.begin(), allowed.end(), experiments) == allowed.end()) {
        table.fail("experiments",
                   "must be [1], [2], [1, 2] or [3]: 1 and 2 are without delay and 3 is with, and a "
                   "participant session "
                   "has one delay; give other people, or another day, a file and a folder of their own");
    }
    return experiments;
}

std::uint32_t whole(const ConfigTable& table, const char* key, std::uint32_t fallback, std::int64_t low,
                    std::int64_t high) {
    return static_cast<std::uint32_t>(table.integer(key, fallback, low, high));
}

}  // namespace

ProtocolSettings read_protocol_settings(const ConfigTable& table) {
    ProtocolSettings p;
    p.experiments = read_experiments(table);
    p.subjects =
        whole(table, "subjects",
              p.experiments == std::vector{3U} ? kSubjectsWithDelay : kSubjectsWithoutDelay, 1, 1'000'000);
    p.trials_per_modality = whole(table, "trials_per_modality", p.trials_per_modality, 1, 100);
    p.removals = whole(table, "removals", p.removals, 1, 100);
    p.practice_trials = whole(table, "practice_trials", p.practice_trials, 0, 1000);
    p.break_every = whole(table, "break_every", p.break_every, 0, 1000);
    p.break_text = table.text("break_text", p.break_text);
    p.break_minimum =
        table.seconds("break_minimum_s", p.break_minimum, Duration{0}, std::chrono::seconds{3600});
    p.repeat = table.choice("repeat", 0, {"end_of_block", "at_once"}) == 0 ? RepeatWhen::kEndOfBlock
                                                                           : RepeatWhen::kAtOnce;
    p.repeats_limit = whole(table, "repeats_limit", p.repeats_limit, 0, 100);
    p.repeat_timeouts = table.boolean("repeat_timeouts", p.repeat_timeouts);
    p.subject_goes_on = read_subject_goes_on(table);
    return p;
}

DatasetSettings read_dataset_settings(const ConfigTable& table) {
    DatasetSettings d;
    d.name = table.text("name", d.name);
    if (d.name.empty()) table.fail("name", "is empty; a dataset needs a name");
    d.license = table.text("license", "");
    d.authors = table.texts("authors", {});
    d.ethics_approvals = table.texts("ethics_approvals", {});
    return d;
}

}  // namespace thimble
