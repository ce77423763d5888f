// WEART TouchDIVERs as the fingertip device, by their maker's middleware (middleware_text.hpp). The middleware knows forces from 0 to 1,
// answers a question for its state, and measures no force for us: the felt force is the newest one sent.
//
// Each tick takes the bytes that are there and sends what the connection takes. Without a connection, an answer, or a device that runs,
// every force is 0. A lost connection is tried anew each second.
// A silent middleware that also does not read loses its connection.
#pragma once

#include <array>

#include "common/byte_stream.hpp"
#include "cutaneous_node/fingertip_actuator.hpp"
#include "cutaneous_node/touchdiver/middleware_text.hpp"

namespace thimble {

class TouchDiverActuator final : public FingertipActuator {
  public:
    static constexpr Duration kPress = std::chrono::milliseconds{10};     // between two forces (a)
    static constexpr Duration kAsk = std::chrono::milliseconds{100};      // between two questions
    static constexpr Duration kSilence = std::chrono::milliseconds{500};  // without an answer: trouble
    static constexpr Duration kTryAgain = std::chrono::seconds{1};
    static constexpr Duration kConnect = std::chrono::seconds{3};  // for a host that says nothing at all

    // `stream` outlives this.
    TouchDiverActuator(const TouchDiverSettings& settings, double force_limit_N, ByteStream& stream);

    void command(SessionTime now, Finger finger, double force_N) override;
    FingertipForce output(SessionTime now) override;
    void release(SessionTime now) override;
    void use_hand(SessionTime now, Hand hand) override;
    void tick(SessionTime now) override;
    SessionTime next_wakeup() const override { return turned_ + kPress; }
    std::string_view fault() const override { return text_; }

    // The end: force 0, and the middleware stops. The words leave in the next ticks.
    void stop();
    bool connected() const { return open_; }
    std::uint64_t forces() const { return forces_; }
    std::uint64_t bad_messages() const { return bad_messages_; }

  private:
    enum class Trouble : std::uint8_t {
        kNone,
        kAbsent,
        kSilent,
        kUnknown,
        kNotRunning,
        kSwitchedOff,
        kNoDevice
    };
    struct Target {
        Finger finger = Finger::kNone;
        double force_N = 0;
        SessionTime commanded{};
    };
    // Of each thimble of both hands, in thousandths of the full force.
    using Pressed = std::array<std::array<int, 3>, 2>;
    static constexpr int kNotToldYet = -1;

    void look_after(SessionTime now);
    void greet(SessionTime now);
    void read(SessionTime now);
    void take(SessionTime now, std::string_view message);
    void take_status(SessionTime now, const MiddlewareStatus& status);
    void ask(SessionTime now);
    void press(SessionTime now);
    void flush();
    void close_if_unread();
    void judge(SessionTime now);
    Trouble trouble_at(SessionTime now) const;
    std::string describe(Trouble trouble) const;
    template <class Use>
    void for_each_thimble(Use&& use) const;
    static int& told(Pressed& pressed, GloveSide side, Thimble thimble) {
        return pressed.at(static_cast<std::size_t>(side)).at(static_cast<std::size_t>(thimble));
    }
    GloveSide side() const { return hand_ == Hand::kActing ? settings_.acting : settings_.other; }
    Pressed wanted() const;

    TouchDiverSettings settings_;
    double limit_N_;
    ByteStream& stream_;
    // Of the node.
    Hand hand_ = Hand::kActing;
    Target target_, felt_;
    // Of the connection.
    bool open_ = false;
    Pressed told_{};
    std::string unsent_;
    std::array<char, 8192> came_{};
    std::size_t came_bytes_ = 0;
    SessionTime turned_{}, tried_{}, heard_{}, asked_{}, started_{}, pressed_{};
    // Of the middleware.
    MiddlewareKind kind_ = MiddlewareKind::kUnknown;
    bool known_ = false, ran_ = false, actuations_ = true;
    std::array<bool, 2> present_{true, true};
    int code_ = 0;
    std::string phase_, problem_;

    Trouble trouble_ = Trouble::kNone;
    bool news_ = true;  // since text_ was made
    std::string text_;
    std::uint64_t forces_ = 0, bad_messages_ = 0;
};

}  // namespace thimble
