// The tissue: a block seen from a little above, its surface a mesh that the vertex shader dents.
#pragma once

#include <glm/glm.hpp>

#include "visual_node/window/picture.hpp"
#include "visual_node/window/shader.hpp"

namespace thimble {

class TissueBlock {
  public:
    TissueBlock();
    ~TissueBlock();
    TissueBlock(const TissueBlock&) = delete;
    TissueBlock& operator=(const TissueBlock&) = delete;

    // `to_clip`: from pixels, y downwards, to clip coordinates.
    void paint(const Picture& picture, const glm::mat4& to_clip) const;

  private:
    Shader shader_;
    GLint to_clip_, surface_, block_, dimple_, tilt_, colour_;
    GLuint array_ = 0, vertices_ = 0, indices_ = 0;
    GLsizei index_count_ = 0;
};

}  // namespace thimble
