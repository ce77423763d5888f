#include "session/participant/agenda.hpp"

#include <algorithm>

namespace thimble {
namespace {

class Positions {
  public:
    Positions(const Agenda& agenda, const ProtocolSettings& settings)
        : agenda_(agenda),
          settings_(settings),
          last_(agenda.order.size(), nullptr),
          failures_(last_.size(), 0) {
        for (const DatasetRecord& record : agenda.records) {
            if (record.position < 1 || record.position > last_.size()) continue;
            last_[record.position - 1] = &record;
            failures_[record.position - 1] += failed_by_itself(record) ? 1 : 0;
        }
    }

    bool fresh(std::size_t i) const { return last_[i] == nullptr; }

    // Why the trial at this place is to be repeated; nothing if it is not.
    std::optional<Step> repeat(std::size_t i) const {
        if (fresh(i)) return std::nullopt;
        const DatasetRecord& record = *last_[i];
        const Exclusion* mark = find_exclusion(agenda_.exclusions, agenda_.participant, record.record);
        if (mark != nullptr && mark->kind == ExclusionKind::kExcluded) return std::nullopt;
        if (mark != nullptr) return Step{agenda_.order[i], record.record, mark->reason};
        // The experimenter asked for it, though nothing had failed.
        const bool again = record.row.reason == EndReason::kInterrupted ||
                           record.row.reason == EndReason::kEmergencyStop ||
                           (failed_by_itself(record) && failures_[i] <= settings_.repeats_limit);
        if (!again) return std::nullopt;
        return Step{agenda_.order[i], record.record, outcome_text(record.row.reason, record.row.lost_peer)};
    }

  private:
    bool failed_by_itself(const DatasetRecord& record) const {
        if (record.row.reason == EndReason::kPeerLost || record.row.reason == EndReason::kDeviceFault ||
            record.row.reason == EndReason::kSafetyStop)
            return true;
        return record.row.reason == EndReason::kTimeout && settings_.repeat_timeouts && !record.practice &&
               !is_attention(agenda_.order[record.position - 1]);
    }

    const Agenda& agenda_;
    const ProtocolSettings& settings_;
    std::vector<const DatasetRecord*> last_;
    std::vector<std::uint32_t> failures_;
};

}  // namespace

std::optional<Step> Agenda::next(const ProtocolSettings& settings) const {
    const Positions positions(*this, settings);
    std::optional<Step> later;  // a repeat that waits for the end of its block
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (later && order[i].block != later->entry.block) return later;
        if (positions.fresh(i)) return Step{order[i], 0, {}};
        auto repeat = positions.repeat(i);
        if (repeat && settings.repeat == RepeatWhen::kAtOnce) return repeat;
        if (repeat && !later) later = std::move(repeat);
    }
    return later;
}

std::size_t Agenda::begun() const {
    return static_cast<std::size_t>(std::count_if(order.begin(), order.end(), [&](const OrderEntry& entry) {
        return std::any_of(records.begin(), records.end(),
                           [&](const DatasetRecord& record) { return record.position == entry.position; });
    }));
}

}  // namespace thimble
