#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "graticule/solver/span.hpp"

namespace graticule {

enum class NoiseKind : std::uint8_t {
  kUnit,         ///< the residual counts as it is
  kSigma,        ///< standard deviations in the residual's units: one for all, or one each
  kInformation,  ///< the inverse covariance: n(n+1)/2 numbers, the upper triangle row by row (as in
                 ///< g2o)
};

/// How much a factor's residual is minded, seen through a pointer: what graphs hand out.
struct NoiseView {
  NoiseKind kind = NoiseKind::kUnit;
  Span<const double> values;
};

/// How much a factor's residual is minded.  Cost is 0.5 r' W r with W the information.
struct Noise {
  NoiseKind kind = NoiseKind::kUnit;
  std::vector<double> values;

  static Noise Unit() { return {}; }
  /// One standard deviation for every component.
  static Noise Sigma(double sigma) { return {NoiseKind::kSigma, {sigma}}; }
  /// One standard deviation a component, in the residual's order and units.
  static Noise Sigmas(std::vector<double> sigmas) { return {NoiseKind::kSigma, std::move(sigmas)}; }
  /// The upper triangle, row by row, of the inverse covariance.
  static Noise Information(std::vector<double> upper_triangle) {
    return {NoiseKind::kInformation, std::move(upper_triangle)};
  }

  NoiseView View() const { return {kind, values}; }
};

/// Throws Error unless the noise fits a residual of this size: right count, finite, sigmas above
/// zero, information positive definite.  A component whose row of the information is exactly zero
/// is legal: it was not measured (a position fix on a pose).
void CheckNoise(NoiseView noise, int residual_size);

/// Whether CheckNoise finds an information matrix of finite numbers positive definite: its upper
/// triangle, row by row, of `size` rows.
bool IsDefiniteInformation(Span<const double> upper_triangle, int size);

/// W = S' S: what a residual is multiplied by so that its cost is half its squared norm.
/// S is upper triangular: the transposed Cholesky factor of the information.
class Whitener {
 public:
  Whitener() = default;
  /// The noise must have passed CheckNoise.
  Whitener(NoiseView noise, int residual_size);

  /// In place: `rows` x `columns` numbers, row-major, `stride` numbers from row to row.
  void Apply(double* matrix, int rows, int columns, int stride) const;

 private:
  enum class Form : std::uint8_t { kNone, kDiagonal, kTriangular };
  Form form_ = Form::kNone;
  std::vector<double> s_;  // diagonal, or the upper triangle row by row
};

}  // namespace graticule
