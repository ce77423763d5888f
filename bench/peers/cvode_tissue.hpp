// Peer: CVODE of SUNDIALS, Adams with fixed-point iteration or BDF with Newton, a dense 2 x 2 matrix and the
// exact Jacobian; its own root finding. It sees changes of sign only: a touch within one of its steps that
// ends again, or a root of even multiplicity, is missed.
#pragma once

#include <memory>
#include <sundials/sundials_types.h>

#include "bench/peers/peer_tissue.hpp"

namespace thimble {

enum class CvodeMethod { kAdams, kBdf };

// The handling of jumps of the needle's velocity. Restarting costs some first-order steps each time; going on
// leaves the jump, which is small for a smooth needle, to an error control that was not made for it.
enum class CvodeJump { kGoOn, kRestart };

class CvodeTissue final : public PeerTissue {
  public:
    // tolerance > 0: absolute (m, m/s) and relative. Throws Error (run failed) if SUNDIALS refuses.
    CvodeTissue(const TissueParameters& parameters, double tolerance, CvodeMethod method, CvodeJump jump);
    ~CvodeTissue() override;

  protected:
    void start(double t_s, const Surface& surface) override;
    void drive_changed() override;
    Arrival integrate(double from_s, double end_s) override;

  private:
    struct Sundials;
    struct Callbacks;

    std::unique_ptr<Sundials> sundials_;
    CvodeJump jump_;
    double reached_s_ = 0;  // t of the last return
};

}  // namespace thimble
