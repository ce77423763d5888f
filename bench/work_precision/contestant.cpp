#include "bench/work_precision/contestant.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "bench/peers/cvode_tissue.hpp"
#include "bench/peers/odeint_tissue.hpp"
#include "slave_sim/exact_tissue.hpp"
#include "slave_sim/stepped_tissue.hpp"

namespace thimble {

namespace {

template <class Solver>
std::uint64_t evaluations_of(const TissueSolver& solver) {
    return static_cast<const Solver&>(solver).evaluations();
}

Contestant exact() {
    return {kExactName, Contestant::kNone, Contestant::kNone,
            [](const TissueParameters& p) { return std::make_unique<ExactTissue>(p); },
            &evaluations_of<ExactTissue>};
}

template <class Rule>
Contestant stepped(double step_s) {
    return {Rule::kName, step_s, Contestant::kNone,
            [step_s](const TissueParameters& p) { return std::make_unique<SteppedTissue<Rule>>(p, step_s); },
            &evaluations_of<SteppedTissue<Rule>>};
}

Contestant odeint(double tolerance) {
    return {OdeintTissue::kName, Contestant::kNone, tolerance,
            [tolerance](const TissueParameters& p) { return std::make_unique<OdeintTissue>(p, tolerance); },
            &evaluations_of<PeerTissue>};
}

struct CvodeVariant {
    const char* name;
    CvodeMethod method;
    CvodeJump jump;
};

constexpr std::array<CvodeVariant, 4> kCvode{{
    {CvodeTissue::kAdamsName, CvodeMethod::kAdams, CvodeJump::kRestart},
    {CvodeTissue::kBdfName, CvodeMethod::kBdf, CvodeJump::kRestart},
    {CvodeTissue::kAdamsGoesOnName, CvodeMethod::kAdams, CvodeJump::kGoOn},
    {CvodeTissue::kBdfGoesOnName, CvodeMethod::kBdf, CvodeJump::kGoOn},
}};

Contestant cvode(const CvodeVariant& v, double tolerance) {
    return {v.name, Contestant::kNone, tolerance,
            [=](const TissueParameters& p) {
                return std::make_unique<CvodeTissue>(p, tolerance, v.method, v.jump);
            },
            &evaluations_of<PeerTissue>};
}

}  // namespace

std::string Contestant::setting() const {
    if (!std::isnan(step_s)) return fmt::format("h = {:g} s", step_s);
    if (!std::isnan(tolerance)) return fmt::format("tolerance {:g}", tolerance);
    return "";
}

const std::vector<std::string_view>& contestant_names() {
    static const std::vector<std::string_view> names{
        kExactName,
        SemiImplicitEuler::kName,
        RungeKutta4::kName,
        ImplicitMidpoint::kName,
        OdeintTissue::kName,
        CvodeTissue::kAdamsName,
        CvodeTissue::kBdfName,
        CvodeTissue::kAdamsGoesOnName,
        CvodeTissue::kBdfGoesOnName,
    };
    return names;
}

std::vector<Contestant> sweep(bool quick) {
    using Values = std::vector<double>;
    const Values steps_s = quick ? Values{1e-3, 1e-4} : Values{1e-3, 1e-4, 1e-5, 1e-6};
    const Values tolerances = quick ? Values{1e-6, 1e-10} : Values{1e-4,  1e-5,  1e-6,  1e-7,  1e-8, 1e-9,
                                                                   1e-10, 1e-11, 1e-12, 1e-13, 1e-14};
    std::vector<Contestant> all{exact()};
    for (const double step_s : steps_s) all.push_back(stepped<SemiImplicitEuler>(step_s));
    for (const double step_s : steps_s) all.push_back(stepped<RungeKutta4>(step_s));
    for (const double step_s : steps_s) all.push_back(stepped<ImplicitMidpoint>(step_s));
    for (const double tolerance : tolerances) all.push_back(odeint(tolerance));
    for (const CvodeVariant& variant : kCvode) {
        for (const double tolerance : tolerances) all.push_back(cvode(variant, tolerance));
    }
    return all;
}

std::vector<Contestant> one_of_each(double step_s) {
    constexpr double kTolerance = 1e-9;
    std::vector<Contestant> all{exact(), stepped<SemiImplicitEuler>(step_s), stepped<RungeKutta4>(step_s),
                                stepped<ImplicitMidpoint>(step_s), odeint(kTolerance)};
    for (const CvodeVariant& variant : kCvode) {
        if (variant.jump == CvodeJump::kRestart) all.push_back(cvode(variant, kTolerance));
    }
    return all;
}

}  // namespace thimble
