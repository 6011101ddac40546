// A pose graph inside a program of its own: solve, read a covariance, grow, and solve again from
// there.

#include <graticule/factors/builtins.hpp>
#include <graticule/factors/make.hpp>
#include <graticule/solver/marginals.hpp>
#include <graticule/solver/solve.hpp>

#include <cmath>
#include <cstdio>

using graticule::BetweenSe2Factor, graticule::Key;

int main() {
  const auto noise = graticule::Noise::Sigmas({0.1, 0.1, 0.02});  // m, m, rad
  graticule::Graph graph(graticule::Builtins());

  // Four sides of a square, 5 m each; the first pose is where the map begins.
  graph.Add(Key("pose:0"), "se2/1", {0, 0, 0}, /*fixed=*/true);
  for (unsigned i = 1; i <= 4; ++i) {
    graph.Add(Key("pose", i), "se2/1", {2.0 * i, 0.5 * i, 1.4 * i});
    graph.Add(
        BetweenSe2Factor(Key("pose", i - 1), Key("pose", i), {5, 0, M_PI / 2}, noise, "odometry"));
  }
  graticule::Solution solution = graticule::Solve(graph);
  std::printf("%s, chi2 %.3g\n", ToString(solution.report.termination).c_str(),
              solution.report.Chi2());

  // How well is the last pose known?  Row-major 3 x 3, along x, y, yaw of the pose itself.
  const auto marginals = ComputeMarginals(graph, solution.values, {Key("pose:4")});
  if (const auto* known = std::get_if<graticule::Marginals>(&marginals))
    std::printf("sigma of x before the loop: %.3f m\n",
                std::sqrt(known->Covariance(Key("pose:4"))[0]));

  // The loop closes: add the new factor, and go on from the values so far.
  graph.SetValues(solution.values);
  graph.Add(BetweenSe2Factor(Key("pose:4"), Key("pose:0"), {0.2, -0.1, 0.01}, noise, "loop"));
  solution = graticule::Solve(graph);
  const auto end = solution.values.At(Key("pose:4"));
  std::printf("%s after %zu steps, chi2 %.3g, pose:4 at %.3f %.3f %.3f\n",
              ToString(solution.report.termination).c_str(), solution.report.Steps(),
              solution.report.Chi2(), end[0], end[1], end[2]);
  return solution.report.termination == graticule::Termination::kConverged ? 0 : 1;
}
