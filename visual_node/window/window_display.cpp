#include "visual_node/window/window_display.hpp"

namespace thimble {
namespace {

constexpr std::size_t kScenes = 1024;  // a second of them at 1 kHz
constexpr std::size_t kShownScenes = 256;
constexpr std::size_t kRareThings = 64;

template <class T>
std::optional<T> take_from(boost::lockfree::spsc_queue<T>& ring) {
    T oldest;
    return ring.pop(oldest) ? std::optional{oldest} : std::nullopt;
}

}  // namespace

WindowDisplay::WindowDisplay(Duration pipeline)
    : pipeline_(pipeline), scenes_(kScenes), pages_(kRareThings), beeps_(kRareThings), shown_(kShownScenes) {}

void WindowDisplay::draw(SessionTime, const Scene& scene) {
    if (!open_ || !scenes_.push(scene)) ++unseen_;
}

std::optional<ShownScene> WindowDisplay::shown(SessionTime now) {
    offer_page();
    if (now < next_shown()) return std::nullopt;
    return take_from(shown_);
}

SessionTime WindowDisplay::next_shown() const {
    return shown_.read_available() == 0 ? kNever : shown_.front().shown_at;
}

void WindowDisplay::turn_page(SessionTime, const Page& page) {
    newest_page_ = page;
    offer_page();
}

// The newest page is the one that is to be read: while a window hangs and the ring is full, it waits here.
void WindowDisplay::offer_page() {
    if (newest_page_ && pages_.push(*newest_page_)) newest_page_.reset();
}

// A full ring has sixty-four of them waiting for a window that hangs: one more says nothing new.
void WindowDisplay::beep(SessionTime now) { static_cast<void>(beeps_.push(now)); }

std::optional<Scene> WindowDisplay::take_scene() { return take_from(scenes_); }
std::optional<Page> WindowDisplay::take_page() { return take_from(pages_); }
std::optional<SessionTime> WindowDisplay::take_beep() { return take_from(beeps_); }

// Full: the node has not looked for four seconds, and percepts that old are worth nothing.
void WindowDisplay::presented(const Scene& scene, SessionTime swapped) {
    static_cast<void>(shown_.push({scene, swapped + pipeline_}));
}

}  // namespace thimble
