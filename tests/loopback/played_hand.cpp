#include "tests/loopback/played_hand.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

constexpr Duration kHandFrame = std::chrono::milliseconds{16};
constexpr double kHandSpeed_m_per_s = 0.02;

std::vector<std::string> play_arguments(const Folder& folder, const PortBlock& ports,
                                        const std::string& settings, const std::vector<std::string>& more) {
    const auto session = folder.write("session.toml",
                                      "[session]\nfixture_jitter_m = 0\n[fixture]\nposition_m = 0.035\n"
                                      "[trial]\ncontact_hold_s = 0.5\n" +
                                          settings);
    return words_in(fmt::format("play {} --record {} --base-port {} --visual-command thimble-visual",
                                session.string(), (folder / "out").string(), ports.base()),
                    more);
}

}  // namespace

PlayedHand::PlayedHand(const std::vector<std::string>& arguments, const std::string& more_settings)
    : sockets_(network_at(ports_.base())),
      hand_(Role::kVisual, 100, {sockets_.outlet(Port::kMasterHand)}),
      view_(ports_.base()),
      child_(built_programs() / "thimble", play_arguments(folder_, ports_, more_settings, arguments),
             folder_ / "words") {}

bool PlayedHand::play(const std::function<bool()>& done) {
    wait_until([&] {
        tick(wall_now());
        return done() || child_.poll();
    });
    return done();
}

bool PlayedHand::play_for(Duration time) {
    const SessionTime end = wall_now() + time;
    return play([end] { return wall_now() >= end; });
}

void PlayedHand::order(OrderKind kind, double value, Modality modality) {
    Order order;
    order.kind = kind;
    order.value = value;
    order.modality = modality;
    view_.order(wall_now(), order);
}

void PlayedHand::network(const char* name) {
    Order order;
    order.kind = OrderKind::kNetwork;
    order.network = *NetworkName::of(name);
    view_.order(wall_now(), order);
}

void PlayedHand::tick(SessionTime now) {
    view_.listen(now);
    if (!present_ || now < next_) return;
    const double way_m = kHandSpeed_m_per_s * to_seconds(kHandFrame);
    wanted_m_ += std::clamp(target_m_ - wanted_m_, -way_m, way_m);
    if (running()) hand_.send(now, trial(), HandInput{wanted_m_, true});
    next_ = now + kHandFrame;
}

}  // namespace thimble
