#pragma once

#include <memory>
#include <string>
#include <vector>

#include "graticule/problems/attenuation/gaussian_process.hpp"
#include "graticule/problems/attenuation/predictor.hpp"
#include "graticule/problems/attenuation/residual_gp.hpp"
#include "graticule/problems/attenuation/tomography_options.hpp"

namespace graticule {

/// The options of whichever method is made.
struct MethodOptions {
  double persistence_s = 30;
  TomographyOptions one_a_class = TomographyOptions::OneAttenuationPerClass();
  TomographyOptions mrt = TomographyOptions::Mrt();
  TomographyOptions matte = TomographyOptions::Matte();
  GaussianProcessOptions mrgp = GaussianProcessOptions::Mrgp();
  GaussianProcessOptions pair_gp;
  ResidualGpOptions residual_gp;
};

/// The methods that MakePredictor knows: mean, log-fit, persistence, one-attenuation-a-class, mrt,
/// matte, mrgp, pair-gp, log-fit+gp, mrt+gp, matte+gp.
const std::vector<std::string>& MethodNames();

/// Throws Error (kUsage): no such method; options that do not hold.
std::unique_ptr<SignalPredictor> MakePredictor(const std::string& name,
                                               const MethodOptions& options = {});

}  // namespace graticule
