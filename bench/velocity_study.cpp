#include "bench/studies.hpp"

namespace thimble {

int velocity_study(int /*argc*/, char** /*argv*/) { return 0; }

}  // namespace thimble
