#include "master/devices/mailbox_handle.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/error.hpp"

namespace thimble {

MailboxHandle::MailboxHandle(const AxisSettings& axis, double force_limit_N, std::uint32_t stop_buttons,
                             std::string name, DeviceMailbox& mailbox)
    : RemoteHandle(std::min(force_limit_N, DeviceMailbox::kMostForce_N)),
      name_(std::move(name)),
      stop_buttons_(stop_buttons),
      mailbox_(&mailbox),
      axis_(axis, std::min(force_limit_N, DeviceMailbox::kMostForce_N)) {
    mailbox_->command({});
}

MailboxHandle::~MailboxHandle() { mailbox_->command({}); }

void MailboxHandle::start_trial(SessionTime now, const OperatorTask& task) {
    const std::string before(fault());
    RemoteHandle::start_trial(now, task);
    if (!before.empty()) fail(before);
}

HandleSample MailboxHandle::read(SessionTime now) {
    HandleSample sample = RemoteHandle::read(now);
    if (may_push()) tell_force(sample.force_hand_N);
    return sample;
}

void MailboxHandle::enable_force(SessionTime now, bool enabled) {
    if (enabled) axis_.hold_here();
    RemoteHandle::enable_force(now, enabled);
}

bool MailboxHandle::take_stop(SessionTime now) {
    RemoteHandle::take_stop(now);
    return (mailbox_->take_buttons() & stop_buttons_) != 0;
}

std::string MailboxHandle::awaits() {
    if (!mailbox_->loss().empty()) throw Error(ExitCode::kRunFailed, "{}: {}", name_, mailbox_->loss());
    if (std::string step = next_step(); !step.empty()) return fmt::format("{}: {}", name_, step);
    return mailbox_->reports() == 0 ? name_ + ": no position yet" : "";
}

void MailboxHandle::listen(SessionTime now) {
    if (!mailbox_->loss().empty())
        fail(fmt::format("{}: {}; then start thimble-master again", name_, mailbox_->loss()));
    if (mailbox_->take_withheld()) {
        ++withheld_ticks_;
        withhold();
    }
    const std::uint32_t reports = mailbox_->reports();
    if (reports == reports_) return;
    reports_ = reports;
    axis_.move_to(now, mailbox_->position_m());
    take_position(now, 0, axis_.position_hand_m());
}

void MailboxHandle::tell_force(double force_hand_N) {
    mailbox_->command(may_push() ? axis_.force_device_N(force_hand_N) : DeviceVector{});
}

void MailboxHandle::describe(nlohmann::ordered_json& report) const {
    RemoteHandle::describe(report);
    report["handle"] = {{"device", name_}, {"reads_without_force", withheld_ticks_}};
    if (!fault().empty()) report["handle"]["fault"] = fault();
}

}  // namespace thimble
