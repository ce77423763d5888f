// In place of beeper.cpp where THIMBLE_AUDIO is off: no OpenAL, no sound, and the notice says why.
#include "visual_node/window/beeper.hpp"

namespace thimble {

struct Beeper::Impl {};

Beeper::Beeper(const Tone& /*tone*/)
    : notice_("no sound: THIMBLE_AUDIO is off in this build, the beep will be silent") {}
Beeper::Beeper(const Tone& tone, Loopback /*loopback*/) : Beeper(tone) {}
Beeper::~Beeper() = default;
bool Beeper::built() { return false; }
void Beeper::beep() {}
void Beeper::render(std::span<std::int16_t> /*samples*/) {}

}  // namespace thimble
