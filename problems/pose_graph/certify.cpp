#include "graticule/problems/pose_graph/certify.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "graticule/problems/pose_graph/certify_descent.hpp"

namespace graticule {
namespace {

// Of a shift, relative to the diagonal: what a factorisation in double precision may hide.
constexpr double kRounding = 1e-13;
// A gap of this a factor is nothing: costs have no unit, and a standard deviation costs 0.5.
constexpr double kNegligible = 1e-9;
constexpr int kNewtonSteps = 3;
constexpr double kLargestShift = 1e8;

template <int kDim>
class Certifier {
 public:
  Certifier(const Program<kDim>& program, const Values& values, const CertifyOptions& options)
      : program_(program),
        options_(options),
        poses_(program.Read(values)),
        minorant_(MakeStandIn(program, poses_, StandIn::kMinorant)),
        matrix_(program) {}

  void Run(Certificate* certificate) {
    certificate->cost = minorant_.cost;
    certificate->exact_factors += minorant_.exact;
    Load();
    // Finer than what is asked for costs nothing where the solution allows it.
    double shift = std::max(kRounding, ShiftFor(1e-3 * options_.optimal_gap * minorant_.cost));
    bool proved = IsPositive(shift);
    const auto is_fine = [&] { return proved && std::abs(dual_.remainder) < 0.01 * Tolerance(); };
    for (int step = 0; step < kNewtonSteps && !is_fine() && GoesOn() && Newton(); ++step)
      proved = IsPositive(shift);
    for (const double part : {0.05, 0.5}) {
      const double larger = ShiftFor(part * Tolerance());
      if (proved || larger < shift || !GoesOn()) continue;
      proved = IsPositive(shift = larger);
    }
    certificate->verdict = proved ? Verdict::kBounded : Verdict::kRefused;
    if (!proved) certificate->eigenvalue = std::numeric_limits<double>::quiet_NaN();
    while (!proved && options_.find_eigenvalue && shift < kLargestShift && GoesOn()) {
      shift = std::max(10 * shift, 1e-6);
      proved = IsPositive(shift);
      if (!proved || !GoesOn()) continue;
      const auto direction = matrix_.SmallestEigenvalue(shift);
      if (direction) certificate->eigenvalue = direction->eigenvalue;
    }
    certificate->factorisations = factorisations_;
    if (proved)
      certificate->lower_bound = std::max(0.0, minorant_.cost - minorant_.shortfall - drop_ -
                                                   dual_.remainder - shift * matrix_.Allowance());
    // Rounding may put the bound above the cost.
    certificate->lower_bound = std::min(certificate->lower_bound, certificate->cost);
    if (certificate->Gap() <= Tolerance()) certificate->verdict = Verdict::kOptimal;
  }

 private:
  double Tolerance() const {
    return std::max(options_.optimal_gap * minorant_.cost,
                    kNegligible * static_cast<double>(program_.statements.size()));
  }
  bool GoesOn() const { return !options_.go_on || options_.go_on(); }
  double ShiftFor(double gap) const { return gap / matrix_.Allowance(); }

  void Load() {
    dual_ = DualAt(program_, minorant_.quadratic, poses_);
    matrix_.Load(minorant_.quadratic, dual_);
  }

  bool IsPositive(double shift) {
    ++factorisations_;
    return matrix_.IsPositive(shift);
  }

  // Where the quadratics are stationary the dual is best: near a solution that converged only so
  // far, and near one that is not theirs.
  bool Newton() {
    DescentOptions options;
    options.max_steps = 1;
    ++factorisations_;
    const Descent descent = Descend(program_, minorant_.quadratic, options, &poses_);
    drop_ += descent.drop;
    if (descent.steps) Load();
    return descent.steps > 0;
  }

  const Program<kDim>& program_;
  const CertifyOptions& options_;
  Poses<kDim> poses_;
  StandInResult<kDim> minorant_;
  CertificateMatrix<kDim> matrix_;
  Dual<kDim> dual_;
  double drop_ = 0;  // of the minorant, from the values to `poses_`
  std::size_t factorisations_ = 0;
};

std::string Number(double number, int digits) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.*g", digits, number);
  return text;
}

std::string Summary(const Certificate& certificate) {
  const std::string bound = "no values cost less than " + Number(certificate.lower_bound, 9);
  const std::string gap = "relative gap " + Number(certificate.RelativeGap(), 2);
  switch (certificate.verdict) {
    case Verdict::kOptimal:
      return "globally optimal, proved: " + bound + " (" + gap + ")";
    case Verdict::kBounded:
      return "not settled: proved only that " + bound + " (" + gap + ")";
    case Verdict::kRefused:
      return "refused: the certificate matrix has " +
             (std::isnan(certificate.eigenvalue)
                  ? "a negative eigenvalue"
                  : "the eigenvalue " + Number(certificate.eigenvalue, 3)) +
             ", so global optimality is not proved" +
             (certificate.lower_bound > 0 ? "; " + bound + " (" + gap + ")" : "");
    case Verdict::kNotApplicable:
      break;
  }
  std::string text = "not applicable: ";
  for (const std::string& reason : certificate.reasons)
    text += (&reason == &certificate.reasons.front() ? "" : "; ") + reason;
  return text;
}

template <int kDim>
bool CertifyIn(const Graph& graph, const Values& values, const CertifyOptions& options,
               Certificate* certificate) {
  const Program<kDim> program = ReadProgram<kDim>(graph, &certificate->reasons);
  if (!certificate->reasons.empty()) return false;
  certificate->exact_factors = graph.FactorCount() - program.statements.size();
  Certifier<kDim>(program, values, options).Run(certificate);
  return true;
}

}  // namespace

Certificate Certify(const Graph& graph, const Values& values, const CertifyOptions& options) {
  graph.CheckLayout(values);
  Certificate certificate;
  certificate.factors = graph.FactorCount();
  if (HasPoses(graph, 2))
    CertifyIn<2>(graph, values, options, &certificate);
  else if (HasPoses(graph, 3))
    CertifyIn<3>(graph, values, options, &certificate);
  else
    certificate.reasons.push_back("no poses (se2/1, se3/1)");
  certificate.summary = Summary(certificate);
  return certificate;
}

std::string ToString(Verdict verdict) {
  switch (verdict) {
    case Verdict::kOptimal:
      return "optimal";
    case Verdict::kBounded:
      return "bounded";
    case Verdict::kRefused:
      return "refused";
    case Verdict::kNotApplicable:
      break;
  }
  return "not_applicable";
}

}  // namespace graticule
