#include "session/participant/order_file.hpp"

#include <array>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "common/text_file.hpp"
#include "session/participant/tsv.hpp"
#include "session/settings/protocol.hpp"

namespace thimble {
namespace {

constexpr std::array<std::string_view, 10> kOrderColumns{
    "position", "block",   "practice",           "experiment",      "trial",
    "modality", "delay_s", "fixture_position_m", "fixture_removed", "seed"};

std::vector<std::string> fields_of(const OrderEntry& entry) {
    const TrialConditions& c = entry.conditions;
    return {std::to_string(entry.position), std::to_string(entry.block),
            entry.practice ? "1" : "0",     std::to_string(c.experiment),
            std::to_string(c.trial),        to_string(c.modality),
            fmt::format("{}", c.delay_s),   fmt::format("{}", c.fixture_position_m),
            c.removes_fixture ? "1" : "0",  std::to_string(c.study_seed)};
}

OrderEntry read_entry(const CsvReader& line, std::uint32_t participant) {
    OrderEntry entry;
    TrialConditions& c = entry.conditions;
    entry.position = line.field(0).whole();
    entry.block = line.field(1).whole();
    entry.practice = line.field(2).flag();
    c.experiment = line.field(3).whole();
    c.trial = line.field(4).whole();
    const auto modality = find_modality(line.field(5).text);
    if (!modality) line.field(5).fail("is none of HF, CF, CCF, VF");
    c.modality = *modality;
    c.delay_s = line.field(6).number();
    c.fixture_position_m = line.field(7).number();
    c.removes_fixture = line.field(8).flag();
    c.study_seed = line.field(9).integer(std::numeric_limits<std::uint64_t>::max());
    c.subject = participant;
    return entry;
}

std::vector<Protocol> protocols_of(const SystemSettings& settings, const ProtocolSettings& plan) {
    std::vector<Protocol> protocols;
    for (const std::uint32_t experiment : plan.experiments) {
        const auto make = experiment == 1 ? experiment_1 : experiment == 2 ? experiment_2 : experiment_3;
        Protocol protocol = make(settings, plan.subjects, settings.plan.seed);
        protocol.trials_per_modality = plan.trials_per_modality;
        protocol.modalities = settings.plan.modalities;
        if (protocol.removals_per_subject > 0) protocol.removals_per_subject = plan.removals;
        protocols.push_back(protocol);
    }
    return protocols;
}

// Each modality in turn, as [session] lists them: a newcomer to the handle knows what comes.
std::vector<OrderEntry> practice_of(const Protocol& protocol, const ProtocolSettings& plan,
                                    std::uint32_t participant) {
    std::vector<OrderEntry> order;
    for (std::uint32_t i = 0; i < plan.practice_trials; ++i) {
        const std::uint32_t trial = kFirstPracticeTrial + i;
        order.push_back(
            {i + 1, 0, true,
             TrialConditions{protocol.seed, protocol.experiment, participant, trial,
                             protocol.modalities[i % protocol.modalities.size()], protocol.delay_s,
                             draw_fixture_position_m(protocol, participant, trial), false}});
    }
    return order;
}

}  // namespace

std::vector<OrderEntry> plan_order(const SystemSettings& settings, std::uint32_t participant) {
    if (!settings.protocol) {
        throw Error(ExitCode::kUsage,
                    "the session file has no table [protocol]: add one, e.g. as in "
                    "deploy/sessions/human.toml");
    }
    const ProtocolSettings& plan = *settings.protocol;
    if (participant > plan.subjects) {
        throw Error(ExitCode::kUsage,
                    fmt::format("participant P{:02} does not fit into [protocol] subjects = {}: correct one "
                                "of them",
                                participant, plan.subjects));
    }
    const std::vector<Protocol> protocols = protocols_of(settings, plan);
    std::vector<OrderEntry> order = practice_of(protocols[0], plan, participant);
    std::uint32_t counted = 0;
    for (const TrialConditions& conditions :
         participant_trials(protocols[0], protocols.size() > 1 ? &protocols[1] : nullptr, participant)) {
        const std::uint32_t block = plan.break_every == 0 ? 1 : 1 + counted++ / plan.break_every;
        order.push_back({static_cast<std::uint32_t>(order.size() + 1), block, false, conditions});
    }
    return order;
}

void write_order(const std::filesystem::path& file, const std::vector<OrderEntry>& order) {
    std::string text = fmt::format("{}\n", fmt::join(kOrderColumns, "\t"));
    for (const OrderEntry& entry : order) text += fmt::format("{}\n", fmt::join(fields_of(entry), "\t"));
    make_folder(file.parent_path());
    write_whole(file, text);
}

std::vector<OrderEntry> read_order(const std::filesystem::path& file, std::uint32_t participant) {
    CsvReader reader(file, kOrderColumns, '\t');
    std::vector<OrderEntry> order;
    while (reader.next()) {
        order.push_back(read_entry(reader, participant));
        if (order.back().position != order.size()) reader.field(0).fail("is not the next position");
    }
    return order;
}

std::string difference(const std::vector<OrderEntry>& written, const std::vector<OrderEntry>& planned) {
    for (std::size_t i = 0; i < std::min(written.size(), planned.size()); ++i) {
        const auto ours = fields_of(written[i]);
        const auto theirs = fields_of(planned[i]);
        for (std::size_t column = 0; column < kOrderColumns.size(); ++column) {
            if (ours[column] == theirs[column]) continue;
            return fmt::format("at position {} {} is {}, the settings give {}", i + 1, kOrderColumns[column],
                               ours[column], theirs[column]);
        }
    }
    if (written.size() == planned.size()) return {};
    return fmt::format("it has {} trials, the settings give {}", written.size(), planned.size());
}

}  // namespace thimble
