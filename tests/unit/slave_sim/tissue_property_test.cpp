// Properties of any needle in any tissue.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "slave_sim/exact_tissue.hpp"
#include "tests/unit/slave_sim/phases.hpp"
#include "tests/unit/slave_sim/random_values.hpp"

namespace thimble {
namespace {

TissueParameters tissue_somewhere() {
    TissueParameters p = random_tissue(-1);
    p.rest_position_m = between(-0.01, 0.03);
    return p;
}

struct Step {
    double duration_s;
    double needle_m;
};

// Strokes, holds and jitter about the surface.
std::vector<Step> random_needle(double rest_m) {
    std::vector<Step> steps;
    double needle_m = rest_m + between(-0.03, 0.03);
    for (int i = 0; i < 40; ++i) {
        const double kind = between(0, 1);
        if (kind < 0.5) needle_m += between(-0.01, 0.01);
        if (kind > 0.8) needle_m = rest_m + between(-0.03, 0.03);
        steps.push_back({decade(-3.3, 0), needle_m});
    }
    return steps;
}

double contact_force_N(const TissueParameters& p, const TissueState& s) {
    return p.stiffness_N_per_m * (s.position_surface_m - p.rest_position_m) +
           p.damping_Ns_per_m * s.velocity_surface_m_per_s;
}

void expect_consistent(const TissueParameters& p, const TissueState& s, double needle_m) {
    RC_ASSERT(std::isfinite(s.position_surface_m) && std::isfinite(s.velocity_surface_m_per_s));
    RC_ASSERT(std::isfinite(s.force_N));
    const double gap_m = needle_m - s.position_surface_m;
    const double rounding_N = 1e-12 * (1 + std::abs(s.velocity_surface_m_per_s) * p.damping_Ns_per_m);
    switch (s.phase) {
        case TissuePhase::kFree:
            RC_ASSERT(gap_m <= 1e-15);
            RC_ASSERT(s.force_N == 0);
            break;
        case TissuePhase::kPenetrated:
            RC_ASSERT(gap_m >= -1e-15);
            break;
        case TissuePhase::kContact:
            RC_ASSERT(std::abs(gap_m) <= 1e-16);
            RC_ASSERT(contact_force_N(p, s) >= -rounding_N);
            RC_ASSERT(contact_force_N(p, s) <= p.puncture_force_N + rounding_N);
            RC_ASSERT(std::abs(s.force_N + contact_force_N(p, s)) <= rounding_N);
            break;
    }
}

TEST(TissueProperty, PhaseAlwaysAgreesWithItsGuards) {
    EXPECT_TRUE(rc::check("guards", [] {
        const TissueParameters p = tissue_somewhere();
        ExactTissue tissue{p};
        tissue.reset(p.rest_position_m - 0.01);
        Transitions events;
        std::size_t transitions = 0;
        for (const Step& step : random_needle(p.rest_position_m)) {
            TissuePhase phase = tissue.state().phase;
            events.clear();
            tissue.advance(step.duration_s, step.needle_m, events);
            expect_consistent(p, tissue.state(), step.needle_m);
            double before_s = 0;
            for (const Transition& e : events) {
                const TissuePhase entered = phase_named(e.phase);
                RC_ASSERT(entered != phase);
                RC_ASSERT(e.offset_s >= before_s && e.offset_s <= step.duration_s * (1 + 1e-15));
                // No way from penetrated to contact, nor from free to penetrated, without the phase between.
                if (phase == TissuePhase::kPenetrated) RC_ASSERT(entered == TissuePhase::kFree);
                if (phase == TissuePhase::kFree) RC_ASSERT(entered == TissuePhase::kContact);
                before_s = e.offset_s;
                phase = entered;
            }
            RC_ASSERT(events.overflows() > 0 || phase == tissue.state().phase);
            transitions += events.size();
        }
        RC_ASSERT(tissue.unresolved_steps() == 0u);
        RC_CLASSIFY(transitions > 0);
    }));
}

// Each step from the same state. With damping: an undamped surface comes back to where it was let go
// tangentially, and whether it touches there is decided by rounding.
TEST(TissueProperty, AStepSplitAlongItsLineIsTheSameStep) {
    EXPECT_TRUE(rc::check("split", [] {
        TissueParameters p = tissue_somewhere();
        if (p.damping_Ns_per_m == 0) p.damping_Ns_per_m = 0.1;
        ExactTissue whole{p};
        double from_m = p.rest_position_m - 0.01;
        whole.reset(from_m);
        for (const Step& step : random_needle(p.rest_position_m)) {
            ExactTissue split = whole;
            Transitions at_once;
            Transitions parts;
            const double cut = between(0.01, 0.99);
            const double first_s = cut * step.duration_s;
            whole.advance(step.duration_s, step.needle_m, at_once);
            split.advance(first_s, from_m + cut * (step.needle_m - from_m), parts);
            const std::size_t before_cut = parts.size();
            split.advance(step.duration_s - first_s, step.needle_m, parts);
            RC_ASSERT(parts.size() == at_once.size());
            for (std::size_t i = 0; i < parts.size(); ++i) {
                const double offset_s = parts[i].offset_s + (i < before_cut ? 0 : first_s);
                RC_ASSERT(std::abs(offset_s - at_once[i].offset_s) <= 1e-9);
                RC_ASSERT(parts[i].phase == at_once[i].phase);
            }
            const TissueState a = whole.state();
            const TissueState b = split.state();
            RC_ASSERT(a.phase == b.phase);
            RC_ASSERT(std::abs(a.position_surface_m - b.position_surface_m) <= 1e-12);
            RC_ASSERT(std::abs(a.velocity_surface_m_per_s - b.velocity_surface_m_per_s) <= 1e-10);
            RC_ASSERT(std::abs(a.force_N - b.force_N) <= 1e-9);
            from_m = step.needle_m;
        }
    }));
}

}  // namespace
}  // namespace thimble
