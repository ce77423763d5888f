#include "session/participant/order_file.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "common/text_file.hpp"
#include "session/participant/tsv.hpp"
#include "session/settings/protocol.hpp"

namespace thimble {
namespace {

using O = OrderEntry;
using C = TrialConditions;

constexpr std::array kOrderColumns{column<O, &O::position>("position"),
                                   column<O, &O::block>("block"),
                                   column<O, &O::practice>("practice"),
                                   column<O, &O::conditions, &C::experiment>("experiment"),
                                   column<O, &O::conditions, &C::trial>("trial"),
                                   column<O, &O::conditions, &C::modality>("modality"),
                                   column<O, &O::conditions, &C::delay_s>("delay_s"),
                                   column<O, &O::conditions, &C::fixture_position_m>("fixture_position_m"),
                                   column<O, &O::conditions, &C::removes_fixture>("fixture_removed"),
                                   column<O, &O::conditions, &C::study_seed>("seed")};
constexpr auto kOrderNames = names_of(kOrderColumns);

std::string field_of(const OrderEntry& entry, std::size_t column) {
    fmt::memory_buffer field;
    kOrderColumns[column].write(field, entry);
    return fmt::to_string(field);
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

// The bar needs no feeling; where it is not shown, the first modality that is.
OrderEntry attention_trial(const Protocol& protocol, std::uint32_t participant, std::uint32_t number) {
    const auto& all = protocol.modalities;
    const bool bar = std::find(all.begin(), all.end(), Modality::kVF) != all.end();
    const std::uint32_t trial = kFirstAttentionTrial + number;
    OrderEntry entry;
    entry.conditions = TrialConditions{protocol.seed,
                                       protocol.experiment,
                                       participant,
                                       trial,
                                       bar ? Modality::kVF : all[0],
                                       protocol.delay_s,
                                       draw_fixture_position_m(protocol, participant, trial),
                                       false};
    return entry;
}

}  // namespace

std::vector<OrderEntry> plan_order(const SystemSettings& settings, std::uint32_t participant) {
    if (!settings.protocol) {
        throw Error(ExitCode::kUsage,
                    "the session file has no table [protocol]: add one, as in deploy/sessions/human.toml");
    }
    const ProtocolSettings& plan = *settings.protocol;
    if (participant > plan.subjects) {
        throw Error(ExitCode::kUsage,
                    "participant P{:02} does not fit into [protocol] subjects = {}: correct one of them",
                    participant, plan.subjects);
    }
    if (settings.plan.delays.size() > 1) {
        throw Error(
            ExitCode::kUsage,
            fmt::format("[session] delays_s names {} delays, but a participant session has one: name one, "
                        "and write a session file for each other delay (thimble study takes all)",
                        settings.plan.delays.size()));
    }
    const std::vector<Protocol> protocols = session_protocols(settings);
    std::vector<OrderEntry> order = practice_of(protocols[0], plan, participant);
    std::uint32_t counted = 0, planned = 0;
    for (const TrialConditions& conditions :
         participant_trials(protocols[0], protocols.size() > 1 ? &protocols[1] : nullptr, participant)) {
        const std::uint32_t block = plan.break_every == 0 ? 1 : 1 + counted++ / plan.break_every;
        order.push_back({static_cast<std::uint32_t>(order.size() + 1), block, false, conditions});
        const std::uint32_t trials = ++planned;
        if (plan.attention_every == 0 || trials % plan.attention_every != 0) continue;
        OrderEntry attention = attention_trial(protocols[0], participant, trials / plan.attention_every - 1);
        attention.position = static_cast<std::uint32_t>(order.size() + 1);
        attention.block = block;
        order.push_back(attention);
    }
    return order;
}

void write_order(const std::filesystem::path& file, const std::vector<OrderEntry>& order) {
    fmt::memory_buffer text;
    fmt::format_to(std::back_inserter(text), "{}\n", fmt::join(kOrderNames, "\t"));
    for (const OrderEntry& entry : order) {
        write_fields(text, kOrderColumns, entry, '\t');
        text.push_back('\n');
    }
    make_folder(file.parent_path());
    write_whole(file, {text.data(), text.size()});
}

std::vector<OrderEntry> read_order(const std::filesystem::path& file, std::uint32_t participant) {
    CsvReader reader(file, kOrderNames, '\t');
    std::vector<OrderEntry> order;
    while (reader.next()) {
        read_fields(reader, kOrderColumns, order.emplace_back());
        order.back().conditions.subject = participant;
        if (order.back().position != order.size()) reader.field(0).fail("is not the next position");
    }
    return order;
}

std::string difference(const std::vector<OrderEntry>& written, const std::vector<OrderEntry>& planned,
                       bool blinded) {
    for (std::size_t i = 0; i < std::min(written.size(), planned.size()); ++i) {
        for (std::size_t column = 0; column < kOrderColumns.size(); ++column) {
            const std::string ours = field_of(written[i], column), theirs = field_of(planned[i], column);
            if (ours == theirs) continue;
            if (blinded) return fmt::format("it differs at position {}", i + 1);
            return fmt::format("at position {} {} is {}, the settings give {}", i + 1, kOrderNames[column],
                               ours, theirs);
        }
    }
    if (written.size() == planned.size()) return {};
    return fmt::format("it has {} trials, the settings give {}", written.size(), planned.size());
}

}  // namespace thimble
