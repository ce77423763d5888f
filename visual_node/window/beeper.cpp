#include "visual_node/window/beeper.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#ifdef THIMBLE_AUDIO
#include <AL/al.h>
#include <AL/alc.h>
#include <AL/alext.h>
#endif

namespace thimble {

std::vector<std::int16_t> samples_of(const Tone& tone, int rate_Hz) {
    const auto count = static_cast<std::size_t>(std::lround(tone.length_s * rate_Hz));
    std::vector<std::int16_t> samples(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double time_s = static_cast<double>(i) / rate_Hz;
        const double fade = std::clamp(std::min(time_s, tone.length_s - time_s) / tone.fade_s, 0.0, 1.0);
        const double wave = std::sin(2 * std::numbers::pi * tone.frequency_Hz * time_s);
        samples[i] = static_cast<std::int16_t>(std::lround(32767 * tone.loudness * fade * wave));
    }
    return samples;
}

#ifdef THIMBLE_AUDIO

struct Beeper::Impl {
    ALCdevice* device = nullptr;
    ALCcontext* context = nullptr;
    ALuint buffer = 0, source = 0;
    LPALCRENDERSAMPLESSOFT render = nullptr;

    Impl() = default;
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
    ~Impl() {
        if (context != nullptr) {
            alDeleteSources(1, &source);
            alDeleteBuffers(1, &buffer);
            alcMakeContextCurrent(nullptr);
            alcDestroyContext(context);
        }
        if (device != nullptr) alcCloseDevice(device);
    }
};

Beeper::Beeper(const Tone& tone) {
    auto impl = std::make_unique<Impl>();
    impl->device = alcOpenDevice(nullptr);
    prepare(tone, std::move(impl));
}

Beeper::Beeper(const Tone& tone, Loopback) {
    const auto open = reinterpret_cast<LPALCLOOPBACKOPENDEVICESOFT>(
        alcGetProcAddress(nullptr, "alcLoopbackOpenDeviceSOFT"));
    auto impl = std::make_unique<Impl>();
    impl->render =
        reinterpret_cast<LPALCRENDERSAMPLESSOFT>(alcGetProcAddress(nullptr, "alcRenderSamplesSOFT"));
    if (open != nullptr && impl->render != nullptr) impl->device = open(nullptr);
    prepare(tone, std::move(impl));
}

bool Beeper::built() { return true; }

void Beeper::prepare(const Tone& tone, std::unique_ptr<Impl> impl) {
    if (impl->device == nullptr) {
        notice_ = "no sound: OpenAL finds no output device, so the beep is silent";
        return;
    }
    const std::array<ALCint, 7> loopback{ALC_FORMAT_CHANNELS_SOFT,
                                         ALC_MONO_SOFT,
                                         ALC_FORMAT_TYPE_SOFT,
                                         ALC_SHORT_SOFT,
                                         ALC_FREQUENCY,
                                         kRate_Hz,
                                         0};
    impl->context = alcCreateContext(impl->device, impl->render == nullptr ? nullptr : loopback.data());
    if (impl->context == nullptr || alcMakeContextCurrent(impl->context) == ALC_FALSE) {
        notice_ = "no sound: OpenAL cannot use its output device, so the beep is silent";
        return;
    }
    const auto samples = samples_of(tone, kRate_Hz);
    alGenBuffers(1, &impl->buffer);
    alBufferData(impl->buffer, AL_FORMAT_MONO16, samples.data(),
                 static_cast<ALsizei>(samples.size() * sizeof(samples[0])), kRate_Hz);
    alGenSources(1, &impl->source);
    alSourcei(impl->source, AL_BUFFER, static_cast<ALint>(impl->buffer));
    impl_ = std::move(impl);
}

void Beeper::beep() {
    if (impl_ == nullptr) return;
    alSourceStop(impl_->source);
    alSourcePlay(impl_->source);
}

void Beeper::render(std::span<std::int16_t> samples) {
    assert(impl_ != nullptr && impl_->render != nullptr);
    impl_->render(impl_->device, samples.data(), static_cast<ALCsizei>(samples.size()));
}

#else

struct Beeper::Impl {};

Beeper::Beeper(const Tone& /*tone*/)
    : notice_("no sound: this build has none (THIMBLE_AUDIO is off), so the beep is silent") {}
Beeper::Beeper(const Tone& tone, Loopback /*loopback*/) : Beeper(tone) {}
bool Beeper::built() { return false; }
void Beeper::beep() {}
void Beeper::render(std::span<std::int16_t> /*samples*/) {}

#endif

Beeper::~Beeper() = default;

}  // namespace thimble
