#include "visual_node/window/painter.hpp"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace thimble {
namespace {

void add_needle(FlatShapes& shapes, const Picture& picture) {
    const double half = picture.needle_width / 2;
    const double x = picture.needle_x;
    const double point = std::min(2 * picture.needle_width, picture.needle_tip_y);  // the taper's length
    const double shoulder = picture.needle_tip_y - point;
    const glm::vec3 white = to_vec3(colours::kNeedle);
    shapes.rectangle(x - half, 0, x + half, shoulder, white);
    // Blunt by a pixel on either side, so that the end is seen where it is and not where the taper becomes thin.
    shapes.triangle({x - half, shoulder}, {x + half, shoulder}, {x + 1, picture.needle_tip_y}, white);
    shapes.triangle({x - half, shoulder}, {x + 1, picture.needle_tip_y}, {x - 1, picture.needle_tip_y},
                    white);
}

void add_bar(FlatShapes& shapes, const Picture::Bar& bar, double scale) {
    const double bottom = bar.top + bar.height;
    const double right = bar.left + bar.full_length;
    shapes.rectangle(bar.left, bar.top, right, bottom, to_vec3(colours::kBarGround));
    shapes.rectangle(bar.left, bar.top, bar.left + bar.length, bottom, to_vec3(colours::kBar));
    const double line = std::max(1.0, std::round(scale));
    const int ticks = static_cast<int>(std::floor(bar.full_N / bar.tick_N * (1 + 1e-12)));
    for (int i = 0; i <= ticks; ++i) {
        const double x = std::round(bar.left + bar.full_length * (i * bar.tick_N / bar.full_N));
        shapes.rectangle(x, bottom, x + line, bottom + 6 * scale, to_vec3(colours::kInk));
    }
}

void add_fingertip(FlatShapes& shapes, const Picture::Fingertip& finger) {
    const auto r = static_cast<float>(finger.radius);
    const glm::vec2 middle(finger.x, finger.y);
    const glm::vec3 skin = to_vec3(colours::kSkin);
    const auto blanching = static_cast<float>(finger.blanching);
    const glm::vec3 nail = glm::mix(skin * 0.85F, to_vec3(colours::kBlanched), blanching);
    shapes.ellipse(middle, {r, 1.35F * r}, skin);
    shapes.rectangle(finger.x - finger.radius, finger.y, finger.x + finger.radius,
                     finger.y + 1.5 * finger.radius, skin);
    shapes.ellipse(middle - glm::vec2(0, 0.35F * r), {0.66F * r, 0.72F * r}, nail);
}

}  // namespace

void Painter::paint(const Picture& picture) {
    const PictureSize& size = picture.size;
    const glm::mat4 to_clip =
        glm::ortho(0.0F, static_cast<float>(size.width), static_cast<float>(size.height), 0.0F);
    glViewport(0, 0, size.width, size.height);
    glDisable(GL_DEPTH_TEST);  // the tissue is painted from back to front, the needle and the rest over it
    glDisable(GL_CULL_FACE);
    glDisable(GL_BLEND);
    tissue_.paint(picture, to_clip);
    add_needle(shapes_, picture);
    if (picture.bar) add_bar(shapes_, *picture.bar, size.content_scale);
    if (picture.fingertip) add_fingertip(shapes_, *picture.fingertip);
    shapes_.paint(to_clip);
}

}  // namespace thimble
