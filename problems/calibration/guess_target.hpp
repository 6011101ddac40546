#pragma once

#include <optional>
#include <vector>

#include "graticule/io/grey_image.hpp"
#include "graticule/problems/calibration/target.hpp"

namespace graticule {

/// A side of a square or tag of a guessed target: pictures do not say how large it is.  The
/// parameters of one camera do not depend on it; distances do.
constexpr double kNominalPitch_m = 0.03;

/// What target these pictures show: its kind, how many columns and rows, its markers, and all
/// ratios. Markers of every family are looked for, and whether where they lie to each other is what
/// a target's ids say; then plain chessboards.  A grid whose last rows were never seen is guessed
/// without them.  None where nothing fits.
///
/// Looks at up to twelve of the pictures; some seconds.
std::optional<Target> GuessTarget(const std::vector<GreyImage>& images);

}  // namespace graticule
