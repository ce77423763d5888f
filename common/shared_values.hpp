// Defaults on which several nodes must agree, each of them once. A session file may change them for all nodes together.
#pragma once

namespace thimble {

// Needle = scale x hand. Prattichizzo, Pacchierotti and Rosati 2012.
inline constexpr double kPositionScale = 3;
// The most that the paper's handle gives (Force Dimension omega.3, CHAI3D's device table). A larger force is clipped. The
// operator knows this full scale.
inline constexpr double kHandleFullScale_N = 12;
// The most that the fingertip device presses: Prattichizzo et al. 2013, "can exert up to 1.5 N".
inline constexpr double kFingerFullScale_N = 1.5;
// The longest bar of the screen.
inline constexpr double kBarFullScale_N = 12;

}  // namespace thimble
