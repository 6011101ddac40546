#pragma once

#include <string>
#include <vector>

#include "graticule/problems/pose_graph/certify.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule {

struct EscapeOptions {
  SolveOptions solve;
  CertifyOptions certify;
  bool chordal = true;    ///< try a chordal start
  bool staircase = true;  ///< then go down along the negative eigenvector
};

/// One more solve, from elsewhere.
struct EscapeAttempt {
  std::string from;  ///< "chordal start", "staircase of rank 4"
  double cost = 0;   ///< 0.5 sum r' W r at its end
  Verdict verdict = Verdict::kNotApplicable;
  double seconds = 0;  ///< wall: start, solve and certificate
};

struct Escape {
  Solution solution;        ///< the cheapest; the given one unless `improved`
  Certificate certificate;  ///< of it
  bool improved = false;
  std::vector<EscapeAttempt> attempts;
};

/// Looks for a cheaper solution of a pose graph where the certificate was refused: solves from a
/// chordal start, then from where the Riemannian staircase leads, lifted along the eigenvector of
/// the smallest eigenvalue.  Ends as soon as a solution is certified, or where `watch`, which sees
/// the steps of all of this, says stop; solve.time_limit_s holds for each solve and for the
/// staircase.  Does nothing for any other verdict.  Never returns a costlier solution.
/// Deterministic.
Escape EscapeMinimum(const Graph& graph, Solution solution, Certificate certificate,
                     const EscapeOptions& options = {}, const Observer& watch = {});

}  // namespace graticule
