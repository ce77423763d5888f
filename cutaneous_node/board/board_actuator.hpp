// A fingertip board on USB (docs/board-protocol.md). Two halves: the node's loop commands and asks, never waiting; the
// device's thread (HidConnection) writes the newest command and reads statuses.
//
// No force outlives its sender: the board goes slack by itself 50 ms after the last good command, and the thread stops
// asking it to press once the node's loop has been silent for kLoopSilence. A board that hangs may keep the thread in a
// write for seconds, so the loop watches for the board's silence too.
#pragma once

#include <array>
#include <atomic>

#include "common/hid/hid_connection.hpp"
#include "cutaneous_node/board/board_reports.hpp"
#include "cutaneous_node/fingertip_actuator.hpp"

namespace thimble {

// The two halves exchange one word each, so neither half ever sees a mixture.
struct alignas(8) BoardTold {
    BoardCommand command;
};
struct alignas(8) BoardFelt {
    std::uint16_t index_mN = 0, thumb_mN = 0;
    std::uint8_t sequence = 0;
    std::uint8_t trouble = 7;  // kAbsent
};
static_assert(std::atomic<BoardTold>::is_always_lock_free && std::atomic<BoardFelt>::is_always_lock_free);

class BoardActuator final : public FingertipActuator, public HidUser {
  public:
    static constexpr Duration kRepeat = std::chrono::milliseconds{5};        // of an unchanged command
    static constexpr Duration kSilence = std::chrono::milliseconds{100};     // of the board: trouble
    static constexpr Duration kLoopSilence = std::chrono::milliseconds{40};  // of the node: slack

    BoardActuator(const HidChoice& choice, double force_limit_N) : choice_(choice), limit_N_(force_limit_N) {}

    // The node's loop.
    void command(SessionTime now, Finger finger, double force_N) override;
    FingertipForce output(SessionTime now) override;
    void release(SessionTime now) override;
    // A worn device stays on its hand. The thread keeps it connected.
    void use_hand(SessionTime /*now*/, Hand /*hand*/) override {}
    void tick(SessionTime /*now*/) override {}
    SessionTime next_wakeup() const override { return kNever; }
    std::string_view fault() const override;

    // The device's thread.
    std::optional<std::size_t> choose(const std::vector<HidDevice>& present, std::string& trouble) override;
    bool attach(const HidDevice& device, std::span<const std::uint8_t> descriptor,
                std::string& trouble) override;
    bool turn(SessionTime now, HidLink& link) override;
    void detach() override;
    std::uint64_t bad_reports() const { return bad_reports_.load(std::memory_order_relaxed); }

  private:
    // 0 to 6: a BoardFault's, kNone: none.
    enum class Trouble : std::uint8_t { kAbsent = 7, kSilent, kOtherVersion };

    void say(SessionTime now, bool press, Finger finger, double force_N);
    void look(SessionTime now);
    bool silent() const;
    void hear(SessionTime now);
    void take(SessionTime now, std::span<const std::uint8_t> report);
    bool write(SessionTime now, HidLink& link);
    void publish(const BoardStatus& status, std::uint8_t trouble);

    HidChoice choice_;
    double limit_N_;
    // Of the loop.
    std::uint8_t sequence_ = 0;
    std::array<SessionTime, 256> commanded_{};  // by sequence
    std::uint32_t signs_seen_ = 0;
    Duration waited_{};  // for the next sign of life, without the loop's own stalls
    // Between both.
    std::atomic<BoardTold> command_{};
    std::atomic<BoardFelt> felt_{};
    std::atomic<std::int64_t> loop_seen_ns_{0};
    std::atomic<std::uint32_t> signs_{0};  // of the board's life
    std::atomic<std::uint64_t> bad_reports_{0};
    // Of the thread.
    SessionTime heard_{}, turned_{}, written_at_{};
    BoardCommand written_;
    std::uint8_t echoed_ = 0;  // sequence of the newest good status
    bool fresh_ = false;       // attached, nothing heard yet
};

}  // namespace thimble
