// Three conditions, eight subjects: the analysis of variance with its correction, Friedman's test with its exact P, and
// which pairs differ.
#include <cstdio>

#include "analysis/statistics/anova.hpp"
#include "analysis/statistics/friedman.hpp"
#include "analysis/statistics/pairwise.hpp"
#include "common/error.hpp"

int main() {
    try {
        // Maximum penetration, mm; value s of each column is subject s.
        const auto table = thimble::SampleTable::from_columns({
            {"HF", {3.1, 2.8, 3.6, 3.3, 2.9, 3.4, 3.0, 3.2}},
            {"CF", {3.9, 3.7, 4.6, 4.1, 3.3, 4.4, 4.0, 3.6}},
            {"VF", {5.2, 4.1, 6.0, 5.5, 4.9, 4.3, 5.1, 5.6}},
        });
        const auto anova = thimble::repeated_anova(table);
        std::printf("F(%g, %g) = %.2f, P = %.2g, after Greenhouse and Geisser %.2g\n", anova.df_conditions,
                    anova.df_error, anova.f, anova.p, anova.p_greenhouse_geisser);
        const auto friedman = thimble::friedman(table);
        std::printf("Friedman: chi-squared = %.2f, exact P = %.2g, W = %.2f\n", friedman.chi_squared,
                    friedman.p(), friedman.kendalls_w);
        for (const auto& pair : thimble::paired_t_tests(table).pairs) {
            std::printf("%s - %s: %+.2f mm, P = %.2g (Holm)\n", table.name(pair.first).c_str(),
                        table.name(pair.second).c_str(), pair.difference, pair.p_holm);
        }
        return 0;
    } catch (const thimble::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return static_cast<int>(error.code());
    }
}
