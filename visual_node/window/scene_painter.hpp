// A scene as its view shows it: with CutAway the cut-away view, else the subject's screen.
#pragma once

#include <optional>

#include "visual_node/window/captions.hpp"
#include "visual_node/window/cutaway.hpp"
#include "visual_node/window/painter.hpp"

namespace thimble {

class ScenePainter : boost::noncopyable {
  public:
    // The scene into the left `size` of a framebuffer that is `framebuffer_width` wide. Before GuiLayer::begin().
    void paint(const Scene& scene, const PictureSize& size, int framebuffer_width) {
        plan_.reset();
        picture_.reset();
        if (!scene.cut_away) {
            picture_ = picture_of(scene, size);
            subject_.paint(*picture_);
            return;
        }
        plan_ = plan_cutaway({0, 0, static_cast<double>(size.width), static_cast<double>(size.height)});
        build_cutaway(scene, *plan_, mesh_);
        mesh_painter_.paint(mesh_, framebuffer_width, size.height);
    }
    // The texts over the last painted scene, and on the subject's screen the needle. After GuiLayer::begin().
    void draw_over(const Scene& scene) const {
        if (picture_) draw_over_tissue(*picture_);
        if (plan_) draw_over_cutaway(scene, *plan_);
    }
    // Where the last cut-away view stands; nothing after a scene without one.
    const std::optional<CutawayPlan>& cutaway() const { return plan_; }

  private:
    Painter subject_;
    MeshPainter mesh_painter_;
    Mesh mesh_;
    std::optional<CutawayPlan> plan_;
    std::optional<Picture> picture_;
};

}  // namespace thimble
