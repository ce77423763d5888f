// Analysis of variance with one factor, between and within subjects. Sums of squares in the data's unit
// squared, F and P without unit. Source of the decompositions: Maxwell and Delaney, "Designing experiments
// and analyzing data", 2nd ed. 2004, chapters 3 (between) and 11 (within).
#pragma once

#include <vector>

#include "analysis/statistics/named_values.hpp"
#include "analysis/statistics/sample_table.hpp"

namespace thimble {

struct OneWayAnova {
    double f = 0;  // ms_between / ms_within
    double df_between = 0;
    double df_within = 0;
    double p = 1;  // P(F >= f)
    double ss_between = 0;
    double ss_within = 0;
    double eta_squared =
        0;  // ss_between / (ss_between + ss_within); with one factor also partial and generalised

    double ms_between() const { return ss_between / df_between; }
    double ms_within() const { return ss_within / df_within; }
};

// Independent groups, of any sizes: at least two groups, no group empty, at least one with two values. Throws
// Error (kData) otherwise, for missing values, and where no group has any spread (F would be infinite).
OneWayAnova one_way_anova(const std::vector<NamedValues>& groups);

struct RepeatedAnova {
    double f = 0;              // ms_conditions / ms_error
    double df_conditions = 0;  // k - 1
    double df_error = 0;       // (n - 1)(k - 1)
    double p = 1;              // P(F >= f), sphericity assumed
    double ss_conditions = 0;
    double ss_subjects = 0;
    double ss_error = 0;  // what neither subject nor condition explains
    // Departure of the differences' variances from equality: 1 without, 1 / (k - 1) at worst. Greenhouse and
    // Geisser, Psychometrika 24, 1959; Huynh and Feldt, J. Educational Statistics 1, 1976, at most 1, not
    // below the former. Each P: both degrees of freedom times epsilon.
    double epsilon_greenhouse_geisser = 1;
    double epsilon_huynh_feldt = 1;
    double p_greenhouse_geisser = 1;
    double p_huynh_feldt = 1;
    double partial_eta_squared = 0;  // ss_conditions / (ss_conditions + ss_error)
    // ss_conditions / (ss_conditions + ss_subjects + ss_error): comparable with a design between subjects
    // (Olejnik and Algina, Psychological Methods 8(4), 2003; Bakeman, Behavior Research Methods 37(3), 2005).
    double generalised_eta_squared = 0;

    double ms_conditions() const { return ss_conditions / df_conditions; }
    double ms_error() const { return ss_error / df_error; }
};

// At least 3 subjects (with 2 there is one residual direction and no sphericity to judge) and 2 conditions.
// Throws Error (kData) otherwise, and where subject and condition explain everything (F would be infinite).
RepeatedAnova repeated_anova(const SampleTable& table);

}  // namespace thimble
