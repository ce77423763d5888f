// The real experimenter's view on a screen of its own, a session that talks to it, and what its last frame shows.
#pragma once

#include <optional>

#include "common/process/child.hpp"
#include "tests/views/fake_session.hpp"
#include "tests/views/virtual_screen.hpp"
#include "visual_node/views/view_layout.hpp"
#include "visual_node/window/image.hpp"

namespace thimble {

// Until so many orders of this kind have come.
bool wait_for(FakeSession& session, OrderKind kind, int count = 1);

class ViewBench {
  public:
    // 800x600 at scale 1 unless the arguments say otherwise.
    explicit ViewBench(const std::vector<std::string>& more_arguments = {});

    bool ready();
    VirtualScreen& screen() { return screen_; }
    std::uint16_t base_port() const { return ports_.base(); }
    // SIGTERM; the last frame. Empty if the view did not end well.
    Image end();

  private:
    VirtualScreen screen_;
    Folder folder_;
    PortBlock ports_;
    std::optional<Child> view_;
};

void view_sleep(double seconds);

// How far a pixel is from a colour: the largest difference of a channel.
int distance(const Image& image, int x, int y, Colour colour);
// Pixels of this colour in the rectangle.
int count_pixels(const Image& image, const Rect& rect, Colour colour);

}  // namespace thimble
