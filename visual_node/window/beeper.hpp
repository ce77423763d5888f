// The beep that ends an insertion, by OpenAL: one tone, made once. Without a sound card there is silence and one notice.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <boost/core/noncopyable.hpp>

namespace thimble {

struct Tone {
    double frequency_Hz = 880;
    double length_s = 0.2;
    double fade_s = 0.005;  // in and out: no click
    double loudness = 0.5;  // of full scale
};

// One channel, 16 bits.
std::vector<std::int16_t> samples_of(const Tone& tone, int rate_Hz);

class Beeper : boost::noncopyable {
  public:
    static constexpr int kRate_Hz = 44100;

    // Opens the default device. Never throws: notice() says why it will be silent.
    explicit Beeper(const Tone& tone = {});
    // A loopback device of ALC_SOFT_loopback instead, from which a test renders what would be heard.
    struct Loopback {};
    Beeper(const Tone& tone, Loopback);
    ~Beeper();

    // False where this build has no sound at all (THIMBLE_AUDIO=OFF).
    static bool built();
    bool can_sound() const { return impl_ != nullptr; }
    const std::string& notice() const { return notice_; }
    // Begins the tone, from its start if it sounds still.
    void beep();
    // Loopback only: the next samples.
    void render(std::span<std::int16_t> samples);

  private:
    struct Impl;
    void prepare(const Tone& tone, std::unique_ptr<Impl> impl);

    std::unique_ptr<Impl> impl_;
    std::string notice_;
};

}  // namespace thimble
