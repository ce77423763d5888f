#include "session/settings/protocol.hpp"

#include <algorithm>
#include <utility>

#include "common/random.hpp"

namespace thimble {
namespace {

template <class T>
void shuffle(std::vector<T>& list, RandomStream& stream) {
    for (std::size_t left = list.size(); left > 1; --left) {
        std::swap(list[left - 1], list[stream.below(static_cast<std::uint32_t>(left))]);
    }
}

Protocol protocol_of(const SystemSettings& settings, std::uint32_t experiment, std::uint32_t subjects,
                     std::uint64_t seed) {
    Protocol protocol;
    protocol.experiment = experiment;
    protocol.subjects = subjects;
    protocol.seed = seed;
    protocol.delay_s = 0;
    protocol.fixture_position_m = settings.slave.fixture_position_m();
    protocol.fixture_jitter_m = settings.plan.fixture_jitter_m;
    protocol.order = settings.plan.order;
    return protocol;
}

std::vector<Modality> shuffled(const Protocol& protocol, std::uint32_t subject) {
    std::vector<Modality> order;
    for (const Modality modality : protocol.modalities) {
        order.insert(order.end(), protocol.trials_per_modality, modality);
    }
    RandomStream stream({protocol.seed, protocol.experiment, subject, 0, Purpose::kOrder});
    shuffle(order, stream);
    return order;
}

// Which modality is which letter of a design; the same for all subjects of `group`.
std::vector<Modality> letters(const Protocol& protocol, std::uint32_t group) {
    std::vector<Modality> list = protocol.modalities;
    RandomStream stream({protocol.seed, protocol.experiment, 0, group, Purpose::kOrder});
    shuffle(list, stream);
    return list;
}

std::vector<Modality> in_williams_rows(const Protocol& protocol, std::uint32_t subject) {
    const auto rows = williams_design(static_cast<std::uint32_t>(protocol.modalities.size()));
    const std::vector<Modality> letter = letters(protocol, 0);
    std::vector<Modality> order;
    for (std::uint32_t block = 0; block < protocol.trials_per_modality; ++block) {
        for (const std::uint32_t i : rows[(subject - 1 + block) % rows.size()]) order.push_back(letter[i]);
    }
    return order;
}

// Subjects in groups of as many as there are modalities: the first removal goes once round the group, each
// further one is one or more letters on, another distance in the next group.
std::vector<Modality> removals(const Protocol& protocol, std::uint32_t subject) {
    const auto n = static_cast<std::uint32_t>(protocol.modalities.size());
    const std::uint32_t group = (subject - 1) / n;
    const std::vector<Modality> letter = letters(protocol, group);
    std::vector<Modality> order;
    for (std::uint32_t i = 0; i < protocol.removals_per_subject; ++i) {
        const std::uint32_t shift = n == 1 || i % n == 0 ? 0 : 1 + (group + i - 1) % (n - 1);
        order.push_back(letter[(subject - 1 + shift) % n]);
    }
    return order;
}

std::vector<Modality> order_of(const Protocol& protocol, std::uint32_t subject) {
    if (protocol.removals_per_subject > 0) return removals(protocol, subject);
    if (protocol.order == TrialOrder::kWilliams) return in_williams_rows(protocol, subject);
    return shuffled(protocol, subject);
}

// `further` spread evenly: the last one at the end.
std::vector<TrialConditions> interleaved(const std::vector<TrialConditions>& trials,
                                         const std::vector<TrialConditions>& further) {
    std::vector<TrialConditions> all;
    std::size_t taken = 0;
    for (std::size_t i = 0; i < further.size(); ++i) {
        const std::size_t until = trials.size() * (i + 1) / further.size();
        while (taken < until) all.push_back(trials[taken++]);
        all.push_back(further[i]);
    }
    return all;
}

bool same_people(const Protocol& protocol, const Protocol& next) {
    return protocol.removals_per_subject == 0 && next.removals_per_subject > 0 &&
           protocol.experiment + 1 == next.experiment && protocol.subjects == next.subjects;
}

}  // namespace

Protocol experiment_1(const SystemSettings& settings, std::uint32_t subjects, std::uint64_t seed) {
    return protocol_of(settings, 1, subjects, seed);
}

Protocol experiment_2(const SystemSettings& settings, std::uint32_t subjects, std::uint64_t seed) {
    Protocol protocol = protocol_of(settings, 2, subjects, seed);
    protocol.removals_per_subject = kRemovals;
    return protocol;
}

Protocol experiment_3(const SystemSettings& settings, std::uint32_t subjects, std::uint64_t seed) {
    Protocol protocol = protocol_of(settings, 3, subjects, seed);
    protocol.delay_s = to_seconds(kDelayOfExperiment3);
    return protocol;
}

std::vector<Protocol> session_protocols(const SystemSettings& settings) {
    const ProtocolSettings plan = settings.protocol.value_or(ProtocolSettings{});
    std::vector<Protocol> protocols;
    for (const std::uint32_t experiment : plan.experiments) {
        Protocol protocol = protocol_of(settings, experiment, plan.subjects, settings.plan.seed);
        protocol.trials_per_modality = plan.trials_per_modality;
        protocol.modalities = settings.plan.modalities;
        if (experiment == 2) protocol.removals_per_subject = plan.removals;
        for (const Duration delay : settings.plan.delays) {
            protocol.delay_s = to_seconds(delay);
            protocols.push_back(protocol);
        }
    }
    return protocols;
}

bool plans_paper_trials(const Protocol& protocol) {
    const Protocol paper;
    const double delay_s = protocol.experiment == 3 ? to_seconds(kDelayOfExperiment3) : 0;
    return protocol.trials_per_modality == paper.trials_per_modality &&
           protocol.modalities == paper.modalities && protocol.delay_s == delay_s &&
           protocol.removals_per_subject == (protocol.experiment == 2 ? kRemovals : 0);
}

double draw_fixture_position_m(const Protocol& protocol, std::uint32_t subject, std::uint32_t trial) {
    RandomStream stream({protocol.seed, protocol.experiment, subject, trial, Purpose::kFixture});
    return protocol.fixture_position_m + protocol.fixture_jitter_m * stream.uniform(-1, 1);
}

// First row 0, 1, n - 1, 2, n - 2, ...; the others by adding 1 to each letter. If n is odd the mirrored rows
// are needed as well.
std::vector<std::vector<std::uint32_t>> williams_design(std::uint32_t conditions) {
    std::vector<std::vector<std::uint32_t>> rows;
    for (std::uint32_t row = 0; row < conditions; ++row) {
        std::vector<std::uint32_t> sequence;
        for (std::uint32_t i = 0; i < conditions; ++i) {
            const std::uint32_t first = i % 2 == 1 ? (i + 1) / 2 : (conditions - i / 2) % conditions;
            sequence.push_back((first + row) % conditions);
        }
        rows.push_back(sequence);
    }
    for (std::uint32_t row = 0; conditions % 2 == 1 && row < conditions; ++row) {
        rows.emplace_back(rows[row].rbegin(), rows[row].rend());
    }
    return rows;
}

std::vector<TrialConditions> subject_trials(const Protocol& protocol, std::uint32_t subject) {
    const std::vector<Modality> order = order_of(protocol, subject);
    std::vector<TrialConditions> trials;
    for (std::uint32_t i = 0; i < order.size(); ++i) {
        trials.push_back({protocol.seed, protocol.experiment, subject, i + 1, order[i], protocol.delay_s,
                          draw_fixture_position_m(protocol, subject, i + 1),
                          protocol.removals_per_subject > 0});
    }
    return trials;
}

std::vector<TrialConditions> participant_trials(const Protocol& protocol, const Protocol* further,
                                                std::uint32_t subject) {
    const std::vector<TrialConditions> own = subject_trials(protocol, subject);
    return further != nullptr ? interleaved(own, subject_trials(*further, subject)) : own;
}

std::vector<TrialConditions> all_trials(const std::vector<Protocol>& protocols) {
    std::vector<TrialConditions> trials;
    for (std::size_t i = 0; i < protocols.size(); ++i) {
        const Protocol* further = i + 1 < protocols.size() && same_people(protocols[i], protocols[i + 1])
                                      ? &protocols[i + 1]
                                      : nullptr;
        for (std::uint32_t subject = 1; subject <= protocols[i].subjects; ++subject) {
            const std::vector<TrialConditions> session_trials =
                participant_trials(protocols[i], further, subject);
            trials.insert(trials.end(), session_trials.begin(), session_trials.end());
        }
        if (further != nullptr) ++i;
    }
    return trials;
}

}  // namespace thimble
