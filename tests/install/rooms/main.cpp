// A program that uses every room: simulates, solves, writes, and reads again.

#include <graticule/factors/builtins.hpp>
#include <graticule/io/bag.hpp>
#include <graticule/io/problem_file.hpp>
#include <graticule/problems/pose_graph/initialise_and_solve.hpp>
#include <graticule/problems/pose_graph/simulate.hpp>
#include <graticule/solver/error.hpp>

#include <cstdio>

int main(int, char** arguments) {
  using namespace graticule;
  const Registry types = Builtins();
  CityOptions options;
  options.robots = 1;
  options.poses_per_robot = 50;
  Recording recording(types);
  recording.graph = SimulateCity(types, options).graph;
  recording.graph.SetValues(Solve(recording.graph).values);
  WriteProblem(arguments[1], recording);
  const Solution again = Solve(ReadProblem(arguments[1], types).graph);
  std::printf("%s after %zu steps\n", ToString(again.report.termination).c_str(),
              again.report.Steps());
  try {
    BagTopics("nowhere.bag");
    return 1;
  } catch (const Error& error) {
    std::printf("%s\n", error.what());
  }
  return again.report.termination == Termination::kConverged ? 0 : 1;
}
