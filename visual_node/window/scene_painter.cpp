#include "visual_node/window/scene_painter.hpp"

#include "visual_node/window/captions.hpp"

namespace thimble {

void ScenePainter::paint(const Scene& scene, const PictureSize& size, int framebuffer_width) {
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

void ScenePainter::draw_over(const Scene& scene) const {
    if (picture_) draw_over_tissue(*picture_);
    if (plan_) draw_over_cutaway(scene, *plan_);
}

}  // namespace thimble
