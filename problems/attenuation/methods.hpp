#pragma once

#include <memory>
#include <string>
#include <vector>

#include "graticule/problems/attenuation/combination.hpp"
#include "graticule/problems/attenuation/gaussian_process.hpp"
#include "graticule/problems/attenuation/predictor.hpp"
#include "graticule/problems/attenuation/residual_gp.hpp"
#include "graticule/problems/attenuation/tomography_options.hpp"

namespace graticule {

/// The options of whichever method is made.
struct MethodOptions {
  MethodOptions();

  double persistence_s = 30;
  TomographyOptions one_a_class = TomographyOptions::OneAttenuationPerClass();
  TomographyOptions mrt = TomographyOptions::Mrt();
  TomographyOptions matte = TomographyOptions::Matte();
  GaussianProcessOptions mrgp = GaussianProcessOptions::Mrgp();
  GaussianProcessOptions pair_gp;
  /// The mean under the best method: the map ignored as in MRT, but finer cells, held together.
  TomographyOptions fine_mrt = FineMrt();
  /// The process on top of a mean; its radio_db only where the mean has no biases of radios.
  ResidualGpOptions residual_gp;
  /// That on top of fine-mrt, which leaves little that places have in common.
  ResidualGpOptions fine_mrt_gp = FineMrtGp();
  CombinationOptions combination;

  static TomographyOptions FineMrt();
  static ResidualGpOptions FineMrtGp();
};

/// The method that predicts recorded sets best (docs/signal_evaluation.md).
constexpr const char* kBestMethod = "combined";

/// The methods that MakePredictor knows: mean, log-fit, persistence, one-attenuation-a-class, mrt,
/// matte, fine-mrt, mrgp, pair-gp; and any of them with "+gp" behind it, a ResidualGp on that mean.
/// The list has log-fit+gp, matte+gp and fine-mrt+gp; combined is a Combination of these three.
const std::vector<std::string>& MethodNames();

/// Throws Error (kUsage): no such method; options that do not hold.
std::unique_ptr<SignalPredictor> MakePredictor(const std::string& name,
                                               const MethodOptions& options = {});

}  // namespace graticule
