#pragma once

#include <cmath>

#include "graticule/solver/report.hpp"

namespace graticule::test {

/// A report that fills every member, with text that markup must escape.
inline Report SampleReport(double rate = 1.1) {
  Report report;
  report.termination = Termination::kConverged;
  report.message = "|cost change| / cost = 3.1e-12 <= 1e-9";
  report.variables = 12;
  report.fixed_variables = 1;
  report.parameters = 33;
  report.factors = 15;
  report.residuals = 45;
  report.degrees_of_freedom = 12;
  report.initial_cost = 100.5;
  report.initial_objective = 90.25;
  for (int i = 0; i <= 8; ++i) {
    Iteration step;
    step.number = i;
    step.accepted = i != 3;
    step.objective = 5.1 + 85.15 * std::exp(-rate * i);
    step.gradient_max_norm = std::exp(-rate * i);
    step.seconds = 1e-3 * (i + 1);
    report.iterations.push_back(step);
  }
  report.final_objective = report.iterations.back().objective;
  report.final_cost = 6.1 / 3;  // no short decimal
  report.shares = {{"between_se2/1", "odometry", 11, 33, 10, 1},
                   {"between_se2/1", "<script>alert(1)</script>", 4, 12, 90.5, 1.03}};
  report.worst = {{14, "between_se2/1", "a & b", {Key("pose:3"), Key("pose:11")}, 31.5, 3, 0.25}};
  report.anchors = {"pose:0"};
  report.warnings = {"loops \"4\" < 5"};
  report.timing.load = {0.01, 0.01};
  report.timing.solve = {0.02, 0.04};
  report.timing.evaluate = 0.005;
  report.timing.linear_solve = 0.012;
  report.timing.total = {0.05, 0.07};
  report.threads = 2;
  report.linear_solver = "sparse_normal_cholesky (suite_sparse, amd)";
  report.options = {{"max_iterations", "100"}};
  report.provenance = {{"graticule", "0.1.0"}};
  return report;
}

}  // namespace graticule::test
