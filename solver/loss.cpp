#include "graticule/solver/loss.hpp"

#include <cmath>
#include <iterator>

#include "graticule/solver/error.hpp"
#include "graticule/solver/nearest.hpp"

namespace graticule {
namespace {

struct Row {
  std::string_view name;
  void (*evaluate)(double s, double a, double rho[3]);
};

// In the order of LossKind.
constexpr Row kRows[] = {
    {"none",
     [](double s, double, double* rho) {
       rho[0] = s;
       rho[1] = 1;
       rho[2] = 0;
     }},
    {"huber",
     [](double s, double a, double* rho) {
       if (s <= a * a) {
         rho[0] = s;
         rho[1] = 1;
         rho[2] = 0;
         return;
       }
       const double r = std::sqrt(s);
       rho[0] = 2 * a * r - a * a;
       rho[1] = a / r;
       rho[2] = -rho[1] / (2 * s);
     }},
    {"soft_l1",
     [](double s, double a, double* rho) {
       const double root = std::sqrt(1 + s / (a * a));
       rho[0] = 2 * a * a * (root - 1);
       rho[1] = 1 / root;
       rho[2] = -rho[1] / (2 * a * a * root * root);
     }},
    {"cauchy",
     [](double s, double a, double* rho) {
       const double inverse = 1 / (1 + s / (a * a));
       rho[0] = a * a * std::log1p(s / (a * a));
       rho[1] = inverse;
       rho[2] = -inverse * inverse / (a * a);
     }},
    {"arctan",
     [](double s, double a, double* rho) {
       const double inverse = 1 / (1 + s * s / (a * a));
       rho[0] = a * std::atan2(s, a);
       rho[1] = inverse;
       rho[2] = -2 * s * inverse * inverse / (a * a);
     }},
    {"tukey",
     [](double s, double a, double* rho) {
       if (s > a * a) {
         rho[0] = a * a / 3;
         rho[1] = rho[2] = 0;
         return;
       }
       const double value = 1 - s / (a * a);
       rho[0] = a * a / 3 * (1 - value * value * value);
       rho[1] = value * value;
       rho[2] = -2 / (a * a) * value;
     }},
    {"geman_mcclure",
     [](double s, double a, double* rho) {
       const double inverse = 1 / (s + a * a);
       rho[0] = s * a * a * inverse;
       rho[1] = a * a * a * a * inverse * inverse;
       rho[2] = -2 * rho[1] * inverse;
     }},
};

}  // namespace

void EvaluateLoss(const Loss& loss, double s, double rho[3]) {
  kRows[static_cast<std::size_t>(loss.kind)].evaluate(s, loss.scale, rho);
}

std::string_view LossName(LossKind kind) { return kRows[static_cast<std::size_t>(kind)].name; }

std::vector<std::string_view> LossNames() {
  std::vector<std::string_view> names;
  for (const Row& row : kRows) names.push_back(row.name);
  return names;
}

Loss MakeLoss(std::string_view name, double scale) {
  for (std::size_t i = 0; i < std::size(kRows); ++i) {
    if (kRows[i].name != name) continue;
    if (!(scale > 0) || !std::isnormal(scale * scale))
      throw Error("expected a loss scale above zero whose square is a number, found " +
                  Shown(scale));
    return {static_cast<LossKind>(i), scale};
  }
  throw Error("there is no loss '" + std::string(name.substr(0, 60)) + "'" +
              DidYouMean(name, LossNames()));
}

}  // namespace graticule
