#include "bench/peers/cvode_tissue.hpp"

#include <cassert>
#include <cstdlib>
#include <cvode/cvode.h>
#include <limits>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "common/error.hpp"

namespace thimble {

static_assert(std::is_same_v<realtype, double>, "SUNDIALS must be built with double precision");

namespace {

void require(int flag, const char* what) {
    if (flag >= 0) return;
    const std::unique_ptr<char, decltype(&std::free)> name(CVodeGetReturnFlagName(flag), &std::free);
    throw Error(ExitCode::kRunFailed, "CVODE: {} failed ({})", what, name.get());
}

// CVODE gives up at some of the tolerances of the sweep. The flag records it.
void silent(int /*code*/, const char* /*module*/, const char* /*function*/, char* /*text*/, void* /*data*/) {}

}  // namespace

struct CvodeTissue::Sundials {
    SUNContext context = nullptr;
    N_Vector y = nullptr;
    SUNMatrix matrix = nullptr;
    SUNLinearSolver linear = nullptr;
    SUNNonlinearSolver nonlinear = nullptr;
    void* memory = nullptr;

    Sundials() = default;
    Sundials(const Sundials&) = delete;
    Sundials& operator=(const Sundials&) = delete;
    ~Sundials() {
        CVodeFree(&memory);
        if (nonlinear != nullptr) SUNNonlinSolFree(nonlinear);
        if (linear != nullptr) SUNLinSolFree(linear);
        if (matrix != nullptr) SUNMatDestroy(matrix);
        if (y != nullptr) N_VDestroy(y);
        if (context != nullptr) SUNContext_Free(&context);
    }
};

struct CvodeTissue::Callbacks {
    static int slope(realtype /*t_s*/, N_Vector y, N_Vector slope, void* self) {
        const double* state = N_VGetArrayPointer(y);
        double* out = N_VGetArrayPointer(slope);
        out[0] = state[1];
        out[1] = static_cast<CvodeTissue*>(self)->acceleration(state[0], state[1]);
        return 0;
    }
    static int gap(realtype t_s, N_Vector y, realtype* gap_m, void* self) {
        gap_m[0] = static_cast<CvodeTissue*>(self)->gap_m(t_s, N_VGetArrayPointer(y)[0]);
        return 0;
    }
    static int jacobian(realtype /*t_s*/, N_Vector /*y*/, N_Vector /*slope*/, SUNMatrix matrix, void* self,
                        N_Vector /*a*/, N_Vector /*b*/, N_Vector /*c*/) {
        const auto& tissue = *static_cast<CvodeTissue*>(self);
        const TissueParameters& p = tissue.parameters();
        SM_ELEMENT_D(matrix, 0, 0) = 0;
        SM_ELEMENT_D(matrix, 0, 1) = 1;
        SM_ELEMENT_D(matrix, 1, 0) = -p.stiffness_N_per_m / p.mass_kg;
        SM_ELEMENT_D(matrix, 1, 1) = -tissue.damping_Ns_per_m() / p.mass_kg;
        return 0;
    }
};

CvodeTissue::CvodeTissue(const TissueParameters& parameters, double tolerance, CvodeMethod method,
                         CvodeJump jump)
    : PeerTissue(parameters), sundials_(std::make_unique<Sundials>()), jump_(jump) {
    assert(tolerance > 0);
    Sundials& s = *sundials_;
    require(SUNContext_Create(nullptr, &s.context), "SUNContext_Create");
    s.y = N_VNew_Serial(2, s.context);
    N_VConst(0, s.y);
    s.memory = CVodeCreate(method == CvodeMethod::kAdams ? CV_ADAMS : CV_BDF, s.context);
    require(CVodeSetErrHandlerFn(s.memory, &silent, nullptr), "CVodeSetErrHandlerFn");
    require(CVodeInit(s.memory, &Callbacks::slope, 0, s.y), "CVodeInit");
    require(CVodeSetUserData(s.memory, this), "CVodeSetUserData");
    require(CVodeSStolerances(s.memory, tolerance, tolerance), "CVodeSStolerances");
    require(CVodeSetMaxNumSteps(s.memory, 100'000), "CVodeSetMaxNumSteps");
    if (method == CvodeMethod::kAdams) {
        s.nonlinear = SUNNonlinSol_FixedPoint(s.y, 0, s.context);
        require(CVodeSetNonlinearSolver(s.memory, s.nonlinear), "CVodeSetNonlinearSolver");
    } else {
        s.matrix = SUNDenseMatrix(2, 2, s.context);
        s.linear = SUNLinSol_Dense(s.y, s.matrix, s.context);
        require(CVodeSetLinearSolver(s.memory, s.linear, s.matrix), "CVodeSetLinearSolver");
        require(CVodeSetJacFn(s.memory, &Callbacks::jacobian), "CVodeSetJacFn");
    }
    require(CVodeRootInit(s.memory, 1, &Callbacks::gap), "CVodeRootInit");
    int rising = 1;
    require(CVodeSetRootDirection(s.memory, &rising), "CVodeSetRootDirection");
    require(CVodeSetNoInactiveRootWarn(s.memory), "CVodeSetNoInactiveRootWarn");
}

CvodeTissue::~CvodeTissue() = default;

void CvodeTissue::start(double t_s, const Surface& surface) {
    Sundials& s = *sundials_;
    NV_Ith_S(s.y, 0) = surface.position_m;
    NV_Ith_S(s.y, 1) = surface.velocity_m_per_s;
    require(CVodeReInit(s.memory, t_s, s.y), "CVodeReInit");
    reached_s_ = t_s;
}

void CvodeTissue::drive_changed() {
    if (jump_ == CvodeJump::kRestart)
        require(CVodeReInit(sundials_->memory, reached_s_, sundials_->y), "CVodeReInit");
}

PeerTissue::Arrival CvodeTissue::integrate(double from_s, double end_s) {
    Sundials& s = *sundials_;
    // CVODE refuses to begin a step of a few rounding errors.
    if (end_s - from_s < 1e-14 * end_s) {
        return {false, end_s, {NV_Ith_S(s.y, 0), NV_Ith_S(s.y, 1)}};
    }
    const double stop_s = may_run_ahead() ? std::numeric_limits<double>::max() : end_s;
    require(CVodeSetStopTime(s.memory, stop_s), "CVodeSetStopTime");
    double t_s = from_s;
    const int flag = CVode(s.memory, end_s, s.y, &t_s, CV_NORMAL);
    require(flag, "CVode");
    check_effort();
    reached_s_ = t_s;
    return {flag == CV_ROOT_RETURN, t_s, {NV_Ith_S(s.y, 0), NV_Ith_S(s.y, 1)}};
}

}  // namespace thimble
