// A handle in the master's loop and the thread that talks to its device share this. A position or a force is one word of 64 bits, so
// neither side waits and no value is torn.
//
// A force that the loop does not renew ends after kUnattended. When the thread has withheld a force, it obeys only commands that the loop
// gave after it had read so. So the guard before the handle allows the force anew.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <string_view>

#include <boost/core/noncopyable.hpp>

#include "master/devices/axis_constraint.hpp"

namespace thimble {

// Three numbers of 20 bits, in steps of `unit`, and a tag of 4 bits. A number beyond the range is cut, no number is zero.
class PackedVector {
  public:
    static constexpr double kMostSteps = (1 << 19) - 1;

    static std::uint64_t pack(const DeviceVector& values, double unit, unsigned tag) {
        std::uint64_t word = tag & 0xfU;
        for (std::size_t i = 0; i < 3; ++i) {
            const double steps = std::isfinite(values[i]) ? std::round(values[i] / unit) : 0;
            const auto whole = static_cast<std::int64_t>(std::clamp(steps, -kMostSteps, kMostSteps));
            word |= (static_cast<std::uint64_t>(whole) & 0xfffffU) << (4 + 20 * i);
        }
        return word;
    }
    static DeviceVector values(std::uint64_t word, double unit) {
        DeviceVector values{};
        for (std::size_t i = 0; i < 3; ++i) {
            const auto high = static_cast<std::int64_t>(word << (40 - 20 * i));  // its sign at the top
            values[i] = static_cast<double>(high >> 44) * unit;
        }
        return values;
    }
    static unsigned tag(std::uint64_t word) { return word & 0xfU; }
};

class DeviceMailbox : boost::noncopyable {
  public:
    static constexpr double kPositionUnit_m = 1e-6, kForceUnit_N = 1e-4;
    static constexpr double kMostForce_N = PackedVector::kMostSteps * kForceUnit_N;
    // The largest coordinate that a word can hold; no arm reaches as far.
    static constexpr double kReach_m = 0.5;
    static constexpr Duration kUnattended = std::chrono::milliseconds{20};

    // The loop's side.
    void command(const DeviceVector& force_N) {
        command_.store(PackedVector::pack(force_N, kForceUnit_N, known_), std::memory_order_release);
        renewals_.fetch_add(1, std::memory_order_release);
    }
    // How many positions have come. 0: there is none.
    std::uint32_t reports() const { return reports_.load(std::memory_order_acquire); }
    DeviceVector position_m() const {
        return PackedVector::values(position_.load(std::memory_order_acquire), kPositionUnit_m);
    }
    // True if the thread gives no force now, or gave none at some time since the last call. Later commands carry the
    // count that was read here.
    bool take_withheld() {
        const unsigned count = withholdings_.load(std::memory_order_acquire) & 0xfU;
        const bool news = count != known_;
        known_ = count;
        return news || withheld_.load(std::memory_order_acquire);
    }
    // Buttons that are down, or have been since the last call: bit i for button i + 1.
    std::uint32_t take_buttons() { return pressed_.exchange(0) | down_.load(std::memory_order_acquire); }
    // Why no more positions will come; empty while the thread runs.
    std::string_view loss() const {
        return lost_.load(std::memory_order_acquire) ? std::string_view(text_.data()) : std::string_view{};
    }

    // The thread's side. Positions within kReach_m.
    void publish(const DeviceVector& position_m, std::uint32_t buttons) {
        pressed_ |= buttons;  // first, so that no reader misses it
        down_.store(buttons, std::memory_order_release);
        position_.store(PackedVector::pack(position_m, kPositionUnit_m, 0), std::memory_order_release);
        reports_.fetch_add(1, std::memory_order_release);
    }
    // The force for the device now. `withhold`: zero, whatever the command.
    DeviceVector carry(SessionTime now, bool withhold) {
        const std::uint32_t renewals = renewals_.load(std::memory_order_acquire);
        const std::uint64_t word = command_.load(std::memory_order_acquire);
        if (renewals != carried_) renewed_ = now;
        carried_ = renewals;
        const std::uint32_t count = withholdings_.load(std::memory_order_relaxed);
        const bool none =
            withhold || now - renewed_ > kUnattended || PackedVector::tag(word) != (count & 0xfU);
        if (none && !withheld_.load(std::memory_order_relaxed))
            withholdings_.store(count + 1, std::memory_order_release);
        withheld_.store(none, std::memory_order_release);
        return none ? DeviceVector{} : PackedVector::values(word, kForceUnit_N);
    }
    // The first reason stays.
    void lose(std::string_view why) {
        if (lost_.load(std::memory_order_relaxed)) return;
        std::copy_n(why.begin(), std::min(why.size(), text_.size() - 1), text_.begin());
        lost_.store(true, std::memory_order_release);
    }

  private:
    std::atomic<std::uint64_t> command_{0}, position_{0};
    std::atomic<std::uint32_t> renewals_{0}, reports_{0}, withholdings_{0}, pressed_{0}, down_{0};
    std::atomic<bool> withheld_{false}, lost_{false};
    std::array<char, 200> text_{};  // written before lost_
    unsigned known_ = 0;            // of the loop
    std::uint32_t carried_ = 0;     // of the thread
    SessionTime renewed_{};
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

}  // namespace thimble
