// A session that a number draws: valid, short, and unlike the others. Its network, scene, compensator and key are drawn as well.
#pragma once

#include <array>
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "common/random.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {

class DrawnSession {
  public:
    // Where it draws a lab key, that is `key`.
    DrawnSession(std::uint32_t number, const std::filesystem::path& key)
        : draw_({815, 0, 0, number, Purpose::kInstance}) {
        session(number);
        scene();
        if (chance(0.6)) {
            add("[control]\ncompensator = '{}'\n",
                one_of({"scaled", "passivity", "energy-bound-memoryless", "energy-bound", "two-layer",
                        "local-fixture", "wave", "two-port"}));
        }
        if (chance(0.2)) add("[guard]\nenergy_limit_J = {}\n", one_of({"0.01", "0.3"}));
        const bool sealed = chance(0.4);
        link("needle", chance(0.5) ? draw_.uniform(0.001, 0.03) : 0, sealed);
        link("force", least_delay_s_, sealed);
        if (sealed) text_ += under_lab_key(key);
    }
    const std::string& text() const { return text_; }

  private:
    struct Delays {
        const char* words;
        double least_s;
    };
    static constexpr std::array kDelays{Delays{"[0.0]", 0}, Delays{"[0.02]", 0.02}, Delays{"[0.05]", 0.05},
                                        Delays{"[0.0, 0.05]", 0}, Delays{"[0.01, 0.1]", 0.01}};

    template <class... Values>
    void add(fmt::format_string<Values...> words, Values&&... values) {
        text_ += fmt::format(words, std::forward<Values>(values)...);
    }
    bool chance(double share) { return draw_.uniform() < share; }
    const char* one_of(std::initializer_list<const char*> words) {
        return words.begin()[draw_.below(static_cast<std::uint32_t>(words.size()))];
    }

    void session(std::uint32_t number) {
        const Delays& delays = kDelays.at(draw_.below(kDelays.size()));
        least_delay_s_ = delays.least_s;
        add("[session]\nseed = {}\nsubject = {}\nmodalities = {}\ndelays_s = {}\nparallel_conditions = {}\n",
            number, 1 + draw_.below(16), one_of({"['HF']", "['CF']", "['VF', 'HF']", "['HF', 'CCF']"}),
            delays.words, 1 + draw_.below(2));
        add("[trial]\ncontact_hold_s = {}\ntimeout_s = 8\n", draw_.uniform(0.1, 0.6));
        add("[master]\nvelocity_estimator = '{}'\n", one_of({"low_pass", "windowed", "foaw", "kalman"}));
    }
    void scene() {
        if (chance(0.4)) {
            add("[slave_sim]\nscene = '{}'\n",
                one_of({"vessel.toml", "layers.toml", "paper.toml", "experiment2.toml"}));
        } else {
            add("[slave_sim]\nsolver = '{}'\n[fixture]\nposition_m = {}\n",
                one_of({"exact", "semi_implicit_euler", "rk4", "implicit_midpoint"}),
                draw_.uniform(0.03, 0.06));
        }
    }
    // Jitter needs a delay. A rate counts bytes and a flipped bit may be anywhere, so what they do is not the same where datagrams are
    // sealed, and in virtual time they are not.
    void link(const char* way, double delay_s, bool sealed) {
        add("[netem.{}]\n", way);
        if (delay_s > 0 && way == std::string("needle")) add("delay_s = {}\n", delay_s);
        if (delay_s > 0 && chance(0.5))
            add("jitter = '{}'\njitter_spread_s = {}\n", one_of({"uniform", "normal", "gamma"}),
                draw_.uniform(0.01, 0.2) * delay_s);
        if (chance(0.4)) add("loss = {}\nloss_burst = {}\n", draw_.uniform(0, 0.05), 1 + draw_.below(4));
        if (chance(0.3)) add("duplicate = {}\n", draw_.uniform(0, 0.05));
        if (delay_s > 0 && chance(0.3)) add("in_order = false\nreorder = {}\n", draw_.uniform(0, 0.05));
        if (!sealed && chance(0.3)) add("corrupt = {}\n", draw_.uniform(0, 0.001));
        if (!sealed && chance(0.3)) add("rate_bits_per_s = {}\n", draw_.uniform(2e6, 1e7));
    }

    RandomStream draw_;
    double least_delay_s_ = 0;
    std::string text_;
};

}  // namespace thimble
