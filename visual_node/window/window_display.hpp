// The Display of a node whose window lives in another thread: a mailbox that neither side ever waits at. The node's thread calls
// what Display has; the window's thread the rest. A window that hangs, is closed or loses its screen leaves the node undisturbed:
// scenes then go nowhere and are counted.
#pragma once

#include <atomic>
#include <cstdint>

#include <boost/lockfree/spsc_queue.hpp>

#include "visual_node/display.hpp"

namespace thimble {

template <class T>
std::optional<T> take_from(boost::lockfree::spsc_queue<T>& ring) {
    T oldest;
    return ring.pop(oldest) ? std::optional{oldest} : std::nullopt;
}

class WindowDisplay final : public Display {
  public:
    // `pipeline`: from a swap's return to light.
    explicit WindowDisplay(Duration pipeline)
        : pipeline_(pipeline),
          scenes_(kScenes),
          pages_(kRareThings),
          beeps_(kRareThings),
          answers_(kRareThings),
          shown_(kShownScenes) {}

    // The node's thread.
    void draw(SessionTime /*now*/, const Scene& scene) override {
        if (!open_ || !scenes_.push(scene)) ++unseen_;
    }

    std::optional<ShownScene> shown(SessionTime now) override {
        offer_page();
        if (now < next_shown()) return std::nullopt;
        return take_from(shown_);
    }

    SessionTime next_shown() const override {
        return shown_.read_available() == 0 ? kNever : shown_.front().shown_at;
    }

    void turn_page(SessionTime /*now*/, const Page& page) override {
        newest_page_ = page;
        offer_page();
    }

    // A full ring holds 64 beeps for a window that hangs: one more may be lost.
    void beep(SessionTime now) override { static_cast<void>(beeps_.push(now)); }
    bool take_go_on() override { return go_on_.exchange(false); }
    std::optional<GivenAnswer> take_answer() override { return take_from(answers_); }
    bool take_stop() override { return stop_.exchange(false); }

    // The window's thread. The next scene, page or beep (when it was asked for) that waits, oldest first.
    std::optional<Scene> take_scene() { return take_from(scenes_); }
    std::optional<Page> take_page() { return take_from(pages_); }
    std::optional<SessionTime> take_beep() { return take_from(beeps_); }
    // This scene has been swapped to the screen.
    // Full: the node has not looked for four seconds, and percepts that old are worth nothing.
    void presented(const Scene& scene, SessionTime swapped) {
        static_cast<void>(shown_.push({scene, swapped + pipeline_}));
    }

    // The subject asks to go on.
    void ask_to_go_on() { go_on_ = true; }
    // The subject has answered. Full: the node has not looked for sixty-four of them; the subject may press again.
    void answer(const GivenAnswer& given) { static_cast<void>(answers_.push(given)); }
    // A person at the window asks everything to stop.
    void ask_to_stop() { stop_ = true; }
    // The window is closed.
    void close() { open_ = false; }

    // Scenes that the window did not take: it was closed, or busy for a second.
    std::uint64_t unseen() const { return unseen_; }

  private:
    static constexpr std::size_t kScenes = 1024;  // a second of them at 1 kHz
    static constexpr std::size_t kShownScenes = 256;
    static constexpr std::size_t kRareThings = 64;

    // The newest page is the one that is to be read: while a window hangs and the ring is full, it waits here.
    void offer_page() {
        if (newest_page_ && pages_.push(*newest_page_)) newest_page_.reset();
    }

    Duration pipeline_;
    boost::lockfree::spsc_queue<Scene> scenes_;
    boost::lockfree::spsc_queue<Page> pages_;
    std::optional<Page> newest_page_;  // the node's thread: did not fit
    boost::lockfree::spsc_queue<SessionTime> beeps_;
    boost::lockfree::spsc_queue<GivenAnswer> answers_;
    boost::lockfree::spsc_queue<ShownScene> shown_;
    std::atomic<bool> open_{true};
    std::atomic<bool> go_on_{false}, stop_{false};
    std::atomic<std::uint64_t> unseen_{0};
};

}  // namespace thimble
