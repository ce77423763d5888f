#include "experiment/protocol.hpp"

#include <utility>

#include "common/random.hpp"

namespace thimble {

Protocol experiment_3(const SystemSettings& settings, std::uint32_t subjects, std::uint64_t seed) {
    Protocol protocol;
    protocol.subjects = subjects;
    protocol.seed = seed;
    protocol.fixture_position_m = settings.slave.fixture_position_m();
    protocol.fixture_jitter_m = settings.plan.fixture_jitter_m;
    return protocol;
}

double draw_fixture_position_m(const Protocol& protocol, std::uint32_t subject, std::uint32_t trial) {
    RandomStream stream({protocol.seed, protocol.experiment, subject, trial, Purpose::kFixture});
    return protocol.fixture_position_m + protocol.fixture_jitter_m * stream.uniform(-1, 1);
}

std::vector<TrialConditions> subject_trials(const Protocol& protocol, std::uint32_t subject) {
    std::vector<Modality> order;
    for (const Modality modality : protocol.modalities) {
        order.insert(order.end(), protocol.trials_per_modality, modality);
    }
    RandomStream stream({protocol.seed, protocol.experiment, subject, 0, Purpose::kOrder});
    for (std::size_t left = order.size(); left > 1; --left) {
        std::swap(order[left - 1], order[stream.below(static_cast<std::uint32_t>(left))]);
    }
    std::vector<TrialConditions> trials;
    for (std::uint32_t i = 0; i < order.size(); ++i) {
        trials.push_back({protocol.seed, protocol.experiment, subject, i + 1, order[i], protocol.delay_s,
                          draw_fixture_position_m(protocol, subject, i + 1)});
    }
    return trials;
}

std::vector<TrialConditions> all_trials(const Protocol& protocol) {
    std::vector<TrialConditions> trials;
    for (std::uint32_t subject = 1; subject <= protocol.subjects; ++subject) {
        for (const TrialConditions& trial : subject_trials(protocol, subject)) trials.push_back(trial);
    }
    return trials;
}

}  // namespace thimble
