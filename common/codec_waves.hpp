// The codec's own, as codec_bodies.hpp: the two bodies with wave variables.
#pragma once

#include "common/codec_bodies.hpp"

namespace thimble {

inline constexpr double kMaxWave_root_W = 1e6;
inline constexpr double kMaxWaveSum_root_W_s = 1e12;
inline constexpr double kMaxWaveEnergy_J = 1e12;

inline wire::WaveBurst to_wire(const WaveBurst& b) {
    return {b.wave_root_W, b.sum_root_W_s, b.energy_J, b.number, b.count};
}

inline WaveBurst from_wire(const wire::WaveBurst& w, Judge& judge) {
    WaveBurst b;
    for (std::size_t i = 0; i < b.wave_root_W.size(); ++i) {
        b.wave_root_W[i] = w.wave_root_W()->Get(static_cast<flatbuffers::uoffset_t>(i));
        judge.number(b.wave_root_W[i], kMaxWave_root_W);
    }
    b.sum_root_W_s = w.sum_root_W_s();
    b.energy_J = w.energy_J();
    b.number = w.number();
    b.count = w.count();
    judge.number(b.sum_root_W_s, kMaxWaveSum_root_W_s);
    judge.number(b.energy_J, 0, kMaxWaveEnergy_J);
    judge.require(b.count <= WaveBurst::kMost);
    return b;
}

inline wire::NeedleWave to_wire(const NeedleWave& b) { return {to_wire(b.command), to_wire(b.waves)}; }

inline NeedleWave from_wire(const wire::NeedleWave& w, Judge& judge) {
    return {from_wire(w.command(), judge), from_wire(w.waves(), judge)};
}

inline wire::ForceWave to_wire(const ForceWave& b) { return {to_wire(b.feedback), to_wire(b.waves)}; }

inline ForceWave from_wire(const wire::ForceWave& w, Judge& judge) {
    return {from_wire(w.feedback(), judge), from_wire(w.waves(), judge)};
}

}  // namespace thimble
