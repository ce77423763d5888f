// The Display of a node whose window lives in another thread: a mailbox that neither side ever waits at. The node's thread calls
// what Display has; the window's thread the rest. A window that hangs, is closed or loses its screen leaves the node undisturbed:
// scenes then go nowhere and are counted.
#pragma once

#include <atomic>
#include <cstdint>

#include <boost/lockfree/spsc_queue.hpp>

#include "visual_node/display.hpp"

namespace thimble {

class WindowDisplay final : public Display {
  public:
    // `pipeline`: from a swap's return to light.
    explicit WindowDisplay(Duration pipeline);

    // The node's thread.
    void draw(SessionTime now, const Scene& scene) override;
    std::optional<ShownScene> shown(SessionTime now) override;
    SessionTime next_shown() const override;
    void turn_page(SessionTime now, const Page& page) override;
    void beep(SessionTime now) override;
    bool take_go_on() override { return go_on_.exchange(false); }
    bool take_stop() override { return stop_.exchange(false); }

    // The window's thread. The next scene, page or beep (when it was asked for) that waits, oldest first.
    std::optional<Scene> take_scene();
    std::optional<Page> take_page();
    std::optional<SessionTime> take_beep();
    // This scene has been swapped to the screen.
    void presented(const Scene& scene, SessionTime swapped);
    // The subject asks to go on.
    void ask_to_go_on() { go_on_ = true; }
    // A person at the window asks everything to stop.
    void ask_to_stop() { stop_ = true; }
    // The window is closed.
    void close() { open_ = false; }

    // Scenes that the window did not take: it was closed, or busy for a second.
    std::uint64_t unseen() const { return unseen_; }

  private:
    void offer_page();

    Duration pipeline_;
    boost::lockfree::spsc_queue<Scene> scenes_;
    boost::lockfree::spsc_queue<Page> pages_;
    std::optional<Page> newest_page_;  // the node's thread: did not fit
    boost::lockfree::spsc_queue<SessionTime> beeps_;
    boost::lockfree::spsc_queue<ShownScene> shown_;
    std::atomic<bool> open_{true};
    std::atomic<bool> go_on_{false}, stop_{false};
    std::atomic<std::uint64_t> unseen_{0};
};

}  // namespace thimble
