#include "browser/page_study.hpp"

#include "session/settings/protocol.hpp"

namespace thimble {

PageStudy::PageStudy(std::uint64_t seed, std::uint32_t subjects)
    : settings_(load_system_settings({})), planned_(all_trials({experiment_3(settings_, subjects, seed)})) {}

bool PageStudy::go_on(unsigned instants) {
    for (; instants > 0 && rows_.size() < planned_.size(); --instants) {
        if (!session_) {
            const TrialConditions& next = planned_[rows_.size()];
            session_ =
                std::make_unique<VirtualSession>(with_force_delay(settings_, from_seconds(next.delay_s)));
            session_->start(next);
        }
        if (session_->step()) continue;
        const TrialRecord& record = session_->session().record();
        if (!record.samples.empty()) simulated_s_ += record.samples.back().time_s;
        rows_.push_back(make_row(record));
        session_.reset();
    }
    return rows_.size() < planned_.size();
}

void PageStudy::write_table(const std::filesystem::path& path) const {
    TrialTable table(path, IfExists::kReplace);
    for (const TrialRow& row : rows_) table.append(row);
}

}  // namespace thimble
