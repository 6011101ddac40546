#pragma once

#include <string>
#include <string_view>

#include "graticule/problems/calibration/target.hpp"

namespace graticule {

/// A page to print on [mm], wider than high.
struct PaperSize {
  double width_mm = 0, height_mm = 0;
};

/// "A0" to "A5", "letter", "legal", "tabloid", "420x297" (mm).  Throws Error (kUsage).
PaperSize PaperSizeOf(std::string_view word);

/// The largest target of this kind that fits the page, with its text.
///
/// `pitch_mm` is Target::pitch_m; 0: a size that suits the page (mosaic: AprilCal's 38.1 on A3, and
/// in proportion).  `columns` and `rows` as Target's, 0: as many as fit.  `family` may be empty:
/// tag36h11, of ChArUco DICT_4X4_250.  Throws Error (kUsage): it does not fit the page, or the
/// family.
struct TargetRequest {
  TargetKind kind = TargetKind::kTagMosaic;
  std::string family;
  PaperSize paper;
  double pitch_mm = 0;
  int columns = 0, rows = 0;
};
Target FitTarget(const TargetRequest& request);

/// The page, at exact scale: the target in the middle, below it what it is and a bar of 100 mm (or
/// 50) to check the print with.  Throws Error (kUsage): the target does not fit the page.
std::string PrintTargetSvg(const Target& target, const PaperSize& paper);

/// Writes it by the name's ending: .svg, .pdf or .png (of 300 dots an inch, or fewer on large
/// pages), and beside it its description, NAME.yaml.  Returns the description's path.
std::string PrintTarget(const std::string& path, const Target& target, const PaperSize& paper);

}  // namespace graticule
