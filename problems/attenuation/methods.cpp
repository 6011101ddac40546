#include "graticule/problems/attenuation/methods.hpp"

#include "graticule/io/text.hpp"
#include "graticule/problems/attenuation/log_fit.hpp"
#include "graticule/problems/attenuation/persistence.hpp"
#include "graticule/problems/attenuation/tomography.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {

MethodOptions::MethodOptions() = default;

TomographyOptions MethodOptions::FineMrt() {
  TomographyOptions options = TomographyOptions::Mrt();
  options.name = "fine-mrt";
  // Tuned on the drive tests/test_robot_df of the set kolak_ble_flat (docs/signal_evaluation.md).
  options.cell_m = 0.5;
  options.lambda = 1.77;
  options.bias_sigma_db = 1.8;
  options.classes[0].rho_db_per_m = 2.25;
  options.classes[0].phi = 0.84;
  return options;
}

ResidualGpOptions MethodOptions::FineMrtGp() {
  ResidualGpOptions options;
  // Tuned as the mean was.
  options.place.length_m = 0.45;
  options.place_db = 0.1;
  options.link_db = 4;
  options.link_s = 5;
  options.offset_db = 0.05;
  options.noise_db = 4.2;
  return options;
}

const std::vector<std::string>& MethodNames() {
  static const std::vector<std::string> names = {
      "mean",    "log-fit",    "persistence", "one-attenuation-a-class",
      "mrt",     "matte",      "fine-mrt",    "mrgp",
      "pair-gp", "log-fit+gp", "matte+gp",    "fine-mrt+gp",
      "combined"};
  return names;
}

std::unique_ptr<SignalPredictor> MakePredictor(const std::string& name,
                                               const MethodOptions& options) {
  if (name == "mean") return std::make_unique<LogFit>(false);
  if (name == "log-fit") return std::make_unique<LogFit>();
  if (name == "persistence") return std::make_unique<Persistence>(options.persistence_s);
  if (name == "one-attenuation-a-class") return std::make_unique<Tomography>(options.one_a_class);
  if (name == "mrt") return std::make_unique<Tomography>(options.mrt);
  if (name == "matte") return std::make_unique<Tomography>(options.matte);
  if (name == "fine-mrt") return std::make_unique<Tomography>(options.fine_mrt);
  if (name == "mrgp") return std::make_unique<GaussianProcess>(options.mrgp);
  if (name == "pair-gp") return std::make_unique<GaussianProcess>(options.pair_gp);
  if (name == "combined") {
    const auto members = [&] {
      Combination::Members all;
      for (const char* member : {"log-fit+gp", "fine-mrt+gp", "matte+gp"})
        all.push_back(MakePredictor(member, options));
      return all;
    };
    return std::make_unique<Combination>(members(), members(), options.combination);
  }
  const std::size_t mean = name.rfind("+gp");
  if (mean != std::string::npos && mean + 3 == name.size() && mean > 0) {
    auto under = MakePredictor(name.substr(0, mean), options);
    ResidualGpOptions residual = name == "fine-mrt+gp" ? options.fine_mrt_gp : options.residual_gp;
    const auto* tomography = dynamic_cast<const Tomography*>(under.get());
    if (tomography != nullptr && tomography->Options().bias != RadioBias::kNone)
      residual.radio_db = 0;
    residual.name = name;
    return std::make_unique<ResidualGp>(std::move(under), residual);
  }
  std::string list;
  for (const std::string& known : MethodNames()) list += (list.empty() ? "" : ", ") + known;
  throw Error("there is no method " + Quoted(name) + "; there are: " + list, ErrorKind::kUsage);
}

}  // namespace graticule
