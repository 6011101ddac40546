#include "graticule/problems/attenuation/tomography_options.hpp"

#include <cmath>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

void Expect(bool holds, const std::string& what) {
  if (!holds) throw Error("tomography: " + what, ErrorKind::kUsage);
}

void ExpectAboveZero(const char* name, double value) {
  Expect(value > 0 && std::isfinite(value),
         std::string(name) + " is " + Shown(value) + "; expected above zero");
}

void ExpectNotBelowZero(const char* name, double value) {
  Expect(value >= 0 && std::isfinite(value),
         std::string(name) + " is " + Shown(value) + "; expected zero or above");
}

}  // namespace

TomographyOptions TomographyOptions::LogFit() {
  TomographyOptions options;
  options.name = "log-fit";
  options.classes.clear();
  options.uses_map = false;
  return options;
}

TomographyOptions TomographyOptions::OneAttenuationPerClass() {
  TomographyOptions options;
  options.name = "one-attenuation-a-class";
  options.cell_m = 0;
  return options;
}

TomographyOptions TomographyOptions::Mrt() {
  TomographyOptions options;
  options.name = "mrt";
  options.uses_map = false;
  options.classes = {{"all", 0, 2}};
  options.class_of = {0, 0, 0};
  options.cell_m = 3;
  return options;
}

void TomographyOptions::Check() const {
  for (const AttenuationClass& c : classes) {
    Expect(std::isfinite(c.rho_db_per_m),
           "rho of class " + c.name + " is " + Shown(c.rho_db_per_m) + " dB/m");
    ExpectAboveZero(("phi of class " + c.name).c_str(), c.phi);
    Expect(!c.name.empty() && c.name.size() <= 18 &&
               c.name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                        "0123456789_.-") == std::string::npos,
           "a class is named '" + c.name + "'; expected 1 to 18 of letters, digits, _ . -");
  }
  for (const std::uint8_t c : class_of)
    Expect(classes.empty() || c < classes.size(),
           "class_of names class " + std::to_string(c) + " of " + std::to_string(classes.size()));
  ExpectNotBelowZero("cell_m", cell_m);
  constexpr double kSmallestCell_m =
      0.05;  // less than wavelengths, and a house is millions of them
  Expect(cell_m == 0 || cell_m >= kSmallestCell_m,
         "cell_m is " + Shown(cell_m) + "; expected " + Shown(kSmallestCell_m) + " or above, or 0");
  ExpectNotBelowZero("lambda", lambda);
  Expect(margin_cells >= 0 && margin_cells <= 8,
         "margin_cells is " + std::to_string(margin_cells) + "; expected 0 to 8");
  ExpectNotBelowZero("outside_m", outside_m);
  Expect(std::isfinite(l0_dbm) && std::isfinite(slope_db), "the path loss is not a number");
  ExpectAboveZero("l0_sigma_db", l0_sigma_db);
  ExpectAboveZero("slope_sigma_db", slope_sigma_db);
  ExpectAboveZero("near_m", near_m);
  ExpectAboveZero("bias_sigma_db", bias_sigma_db);
  ExpectAboveZero("sigma_db", sigma_db);
  ExpectAboveZero("sigma_weight", sigma_weight);
  Expect(correlation < 1, "correlation is " + Shown(correlation) + "; expected below 1");
  ExpectNotBelowZero("forget_s", forget_s);
  ExpectNotBelowZero("merge_m", merge_m);
  ExpectNotBelowZero("merge_share", merge_share);
  ExpectNotBelowZero("merge_s", merge_s);
  ExpectAboveZero("tolerance", tolerance);
  Expect(max_iterations > 0, "max_iterations is not above zero");
  Expect(update_iterations > 0, "update_iterations is not above zero");
  Expect(samples >= 0 && samples % 16 == 0 && samples <= 1024,
         "samples is " + std::to_string(samples) + "; expected a multiple of 16, up to 1024");
  Expect(exact_up_to >= 2 && exact_up_to <= 5000,
         "exact_up_to is " + std::to_string(exact_up_to) + "; expected 2 to 5000");
}

}  // namespace graticule
