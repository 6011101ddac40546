#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace graticule {

enum class LossKind : std::uint8_t {
  kNone,
  kHuber,
  kSoftL1,
  kCauchy,
  kArctan,
  kTukey,
  kGemanMcClure
};

/// How far a factor is believed when it disagrees.  A factor with whitened squared norm s = r' W r
/// costs 0.5 rho(s).  `scale` is the whitened norm where the loss leaves the parabola.
struct Loss {
  LossKind kind = LossKind::kNone;
  double scale = 1;

  friend bool operator==(const Loss& a, const Loss& b) {
    return a.kind == b.kind && a.scale == b.scale;
  }
};

/// rho(s), rho'(s), rho''(s), with rho(0) = 0 and rho'(0) = 1.
/// Formulas as in Ceres' loss_function.h; Geman-McClure: s a^2 / (s + a^2).
void EvaluateLoss(const Loss& loss, double s, double rho[3]);

/// "huber"; "none" for no loss.
std::string_view LossName(LossKind kind);
std::vector<std::string_view> LossNames();

/// A loss from its name and scale.  Throws Error (unknown name, with the nearest one; scale not
/// above zero).
Loss MakeLoss(std::string_view name, double scale);

}  // namespace graticule
