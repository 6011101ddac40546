#pragma once

#include <cmath>
#include <stdexcept>
#include <vector>

#include "graticule/factors/normal_tail.hpp"
#include "graticule/factors/sdk.hpp"

namespace graticule {

// Strength of a radio signal (thesis, equations 3.1 and 3.2):
//
//     predicted = L0 - a log10(d / 1 m) - sum_k weight_k term_k   [dBm]
//
// with the path loss [L0 dBm, a dB] and terms that are each a scalar variable: the attenuation
// [dB/m] of a class of matter in a cell, weighed by the ray's length in it [m]; or a radio's bias
// [dB], weighed by -1.

namespace signal {

/// The path loss and its terms, from `numbers`: log10 of the distance in metres, then the weights.
struct Path {
  std::vector<double> numbers;

  Path(const double* from, int size, int blocks) : numbers(from, from + size) {
    if (size != blocks) throw std::invalid_argument("expected as many weights as terms");
  }

  double Predict(const double* const* blocks) const {
    double dbm = blocks[0][0] - numbers[0] * blocks[0][1];
    for (std::size_t k = 1; k < numbers.size(); ++k) dbm -= numbers[k] * blocks[k][0];
    return dbm;
  }

  /// Jacobians of slope * prediction.
  void Fill(double slope, double** jacobians) const {
    if (jacobians[0]) {
      jacobians[0][0] = slope;
      jacobians[0][1] = -slope * numbers[0];
    }
    for (std::size_t k = 1; k < numbers.size(); ++k)
      if (jacobians[k]) jacobians[k][0] = -slope * numbers[k];
  }
};

/// A measured strength.
template <class Names>
struct Heard : Names {
  double dbm;
  Path path;

  Heard(Measurement m, int blocks) : dbm(m[0]), path(m.values + 1, m.size - 1, blocks) {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    residual[0] = path.Predict(blocks) - dbm;
    if (jacobians) path.Fill(1, jacobians);
    return true;
  }
};

/// A strength of which only is known that it was below a floor, by noise of `sigma`.
/// Half of the residual's square is -log Phi((floor - predicted) / sigma) (Tobin 1958).
template <class Names>
struct NotHeard : Names {
  double floor_dbm, sigma_db;
  Path path;

  NotHeard(Measurement m, int blocks)
      : floor_dbm(m[0]), sigma_db(m[1]), path(m.values + 2, m.size - 2, blocks) {
    if (!(sigma_db > 0)) throw std::invalid_argument("expected a sigma above zero");
  }

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    const double z = (floor_dbm - path.Predict(blocks)) / sigma_db;
    residual[0] = std::sqrt(2 * MinusLogNormalCdf(z));
    // Far above the floor's noise the residual vanishes, and its slope sooner than that.
    if (jacobians)
      path.Fill(residual[0] > 0 ? NormalHazard(z) / (residual[0] * sigma_db) : 0, jacobians);
    return true;
  }
};

struct PathLossNames {
  static constexpr const char* kName = "path_loss/1";
  static constexpr const char* kSchema =
      "path_loss:vector2/1 | strength:dBm log_distance | strength:dB";
  static constexpr const char* kSummary = "signal strength by distance alone";
};

struct SignalPathNames {
  static constexpr const char* kName = "signal_path/1";
  static constexpr const char* kSchema =
      "path_loss:vector2/1 term:vector1/1* | strength:dBm log_distance weight* | strength:dB";
  static constexpr const char* kSummary = "signal strength through attenuating cells, with biases";
};

struct PathLossNotHeardNames {
  static constexpr const char* kName = "path_loss_not_heard/1";
  static constexpr const char* kSchema =
      "path_loss:vector2/1 | floor:dBm sigma:dB log_distance | tail";
  static constexpr const char* kSummary = "a packet not heard, by distance alone";
};

struct SignalPathNotHeardNames {
  static constexpr const char* kName = "signal_path_not_heard/1";
  static constexpr const char* kSchema =
      "path_loss:vector2/1 term:vector1/1* | floor:dBm sigma:dB log_distance weight* | tail";
  static constexpr const char* kSummary = "a packet not heard through attenuating cells";
};

}  // namespace signal

/// Residual [dB]: predicted - measured; zero when they agree.  Distance as log10 of metres.
using PathLoss = signal::Heard<signal::PathLossNames>;
/// The same with terms, and one weight each.
using SignalPath = signal::Heard<signal::SignalPathNames>;
/// Residual, without a unit: sqrt(-2 log Phi((floor - predicted) / sigma)), which falls to zero far
/// below the floor and rises as the whitened excess far above it.  Its noise is in it: leave the
/// factor's noise at unit, or 1 / sqrt(n) for n packets.
using PathLossNotHeard = signal::NotHeard<signal::PathLossNotHeardNames>;
using SignalPathNotHeard = signal::NotHeard<signal::SignalPathNotHeardNames>;

/// Two scalars are known to differ by what was measured, commonly by nothing: neighbouring cells of
/// a class.  Residual [dB/m]: a - b - difference.  Thesis, equation 3.5.
struct AttenuationSmooth {
  static constexpr const char* kName = "attenuation_smooth/1";
  static constexpr const char* kSchema = "a:vector1/1 b:vector1/1 | difference:dB/m";
  static constexpr const char* kSummary = "neighbouring cells attenuate alike";

  double difference_db_per_m;

  explicit AttenuationSmooth(Measurement m) : difference_db_per_m(m[0]) {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    residual[0] = blocks[0][0] - blocks[1][0] - difference_db_per_m;
    if (jacobians && jacobians[0]) jacobians[0][0] = 1;
    if (jacobians && jacobians[1]) jacobians[1][0] = -1;
    return true;
  }
};

namespace signal {

/// Numbers are what is believed of them: value - believed.
template <class Names, int kSize>
struct Prior : Names {
  double believed[kSize];

  explicit Prior(Measurement m) {
    for (int i = 0; i < kSize; ++i) believed[i] = m[i];
  }

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const {
    for (int i = 0; i < kSize; ++i) residual[i] = blocks[0][i] - believed[i];
    if (!jacobians || !jacobians[0]) return true;
    for (int i = 0; i < kSize * kSize; ++i) jacobians[0][i] = i % (kSize + 1) == 0 ? 1 : 0;
    return true;
  }
};

struct AttenuationPriorNames {
  static constexpr const char* kName = "attenuation_prior/1";
  static constexpr const char* kSchema = "cell:vector1/1 | attenuation:dB/m";
  static constexpr const char* kSummary = "attenuation of a class is about this";
};

struct RadioBiasPriorNames {
  static constexpr const char* kName = "radio_bias_prior/1";
  static constexpr const char* kSchema = "bias:vector1/1 | bias:dB";
  static constexpr const char* kSummary = "a radio's bias is about this";
};

struct PathLossPriorNames {
  static constexpr const char* kName = "path_loss_prior/1";
  static constexpr const char* kSchema = "path_loss:vector2/1 | strength:dBm slope:dB";
  static constexpr const char* kSummary = "strength at 1 m and loss a decade are about these";
};

}  // namespace signal

/// Residuals in the units of what is believed, value - believed; zero when they agree.
using AttenuationPrior = signal::Prior<signal::AttenuationPriorNames, 1>;  ///< thesis 3.2.3: phi
using RadioBiasPrior = signal::Prior<signal::RadioBiasPriorNames, 1>;
using PathLossPrior = signal::Prior<signal::PathLossPriorNames, 2>;

}  // namespace graticule
