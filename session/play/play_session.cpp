#include "session/play/play_session.hpp"

#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/process/progress.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/text_file.hpp"
#include "session/play/order_handlers.hpp"
#include "session/play/play_starter.hpp"
#include "session/records/condition_summary.hpp"
#include "session/records/trajectory_file.hpp"
#include "session/records/trial_table.hpp"
#include "session/run/condition_run.hpp"
#include "session/settings/protocol.hpp"

namespace thimble {
namespace {

constexpr Duration kLook = std::chrono::milliseconds{20};

// Each further trial would lose its data, too.
void require_whole_files(const ConditionResult& result) {
    if (!result.write_fault.empty()) throw Error(ExitCode::kRunFailed, result.write_fault);
}

class Play {
  public:
    Play(const SystemSettings& settings, const PlayOptions& options)
        : options_(options),
          protocol_(experiment_3(settings, settings.plan.subject, settings.plan.seed)),
          subject_(std::max(1U, settings.plan.subject)),
          handler_(options.modality) {
        if (!options.record.empty()) {
            make_folder(options.record);
            table_.emplace(options.record / "trials.csv");
        } else {
            scratch_.emplace();
        }
        events_.stop = [this] { return over(); };
        fill_in_plan(settings);
    }

    PlayResult run() {
        try {
            return run_trials();
        } catch (const Error& error) {
            // Logs that the words name are there to be read.
            const bool named = scratch_ && std::string_view(error.what()).find(scratch_->path().string()) !=
                                               std::string_view::npos;
            if (named) scratch_->keep();
            throw;
        }
    }

  private:
    PlayResult run_trials() {
        ConditionRun condition(plan_, events_);
        condition.open();
        end_ = options_.longest == Duration::max() ? kNever : wall_now() + options_.longest;
        say("move the mouse in the window; to end, close the window or press Ctrl-C");
        while (!over()) {
            condition.check();
            if (const std::string stopped = condition.stop_text(); !stopped.empty()) {
                if (stopped != stop_said_) say(stopped);
                stop_said_ = stopped;
                condition.show(waiting(PageKind::kPaused));
                condition.idle(kLook);
                continue;
            }
            stop_said_.clear();
            if (const auto modality = handler_.take_due(wall_now())) {
                do_trial(condition, *modality);
            } else {
                condition.show(waiting(handler_.context().paused ? PageKind::kPaused : PageKind::kReady));
                condition.idle(kLook);
            }
        }
        const ConditionResult closed = condition.close();
        if (const std::string stopped = condition.stop_text(); !stopped.empty() && stopped != stop_said_)
            say(stopped);
        require_whole_files(closed);
        return {trials_};
    }

    void fill_in_plan(const SystemSettings& settings) {
        plan_.starter = options_.starter;
        plan_.out = (table_ ? options_.record : scratch_->path()) / "nodes";
        plan_.network = options_.network;
        plan_.session = session_settings(with_force_delay(settings, from_seconds(options_.delay_s)));
        plan_.session.ends_by_withdrawal = true;
        plan_.session.trial_timeout = kPlayTimeout;
        plan_.delay_s = options_.delay_s;
        plan_.runtime = settings.runtime;
        plan_.session_file = settings.file;
        plan_.make_observer = [this](SessionProcess& session, Sockets& sockets, const std::string&) {
            handler_.serve(session);
            session_ = &session;
            return make_observer(session, sockets, handler_, handler_.context());
        };
    }

    bool over() const {
        return handler_.quit() || (options_.stop != nullptr && *options_.stop) || wall_now() >= end_ ||
               options_.starter->window_closed();
    }

    void do_trial(ConditionRun& condition, Modality modality) {
        TrialConditions conditions{protocol_.seed,
                                   protocol_.experiment,
                                   subject_,
                                   ++trials_,
                                   modality,
                                   session_->delay_s(),
                                   draw_fixture_position_m(protocol_, subject_, trials_)};
        std::filesystem::path file;
        if (table_) {
            file = options_.record / "trajectories" / trajectory_name(conditions);
        }
        const TrialRecord& record = condition.run_trial(conditions, condition.last_number() + 1, file);
        handler_.trial_ended(wall_now(), record);
        const TrialRow row = make_row(record);
        if (table_) table_->append(row);
        say(fmt::format("trial {}, {} {}: {}, {:.1f} s, contacts lost {}", trials_,
                        delay_text(conditions.delay_s), to_string(modality),
                        outcome_text(row.reason, row.lost_peer), row.metrics.duration_s,
                        row.metrics.contacts_lost));
        if (!record.fault.empty()) say(record.fault);
        require_whole_files(condition.result());
        if (!over()) condition.check();
    }

    Page waiting(PageKind kind) const {
        Page page;
        page.kind = kind;
        page.trial = trials_ + 1;
        return page;
    }

    void say(const std::string& line) { progress_.say(line); }

    const PlayOptions& options_;
    Protocol protocol_;
    std::uint32_t subject_;
    PlayHandler handler_;
    std::optional<TrialTable> table_;
    std::optional<ScratchFolder> scratch_;
    Progress progress_;
    ConditionPlan plan_;
    ConditionEvents events_;
    SessionProcess* session_ = nullptr;  // the condition's
    SessionTime end_ = kNever;
    std::uint32_t trials_ = 0;
    std::string stop_said_;
};

}  // namespace

PlayResult play(const SystemSettings& settings, const PlayOptions& options) {
    return Play(settings, options).run();
}

}  // namespace thimble
