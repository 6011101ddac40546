#include "bind.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/problems/pose_graph/certify.hpp"
#include "graticule/problems/pose_graph/initialise_and_solve.hpp"
#include "graticule/problems/pose_graph/simulate.hpp"
#include "observer.hpp"

namespace graticule::python {
namespace {

using namespace py::literals;

InitialGuess GuessOf(const std::string& how) {
  InitialiseOptions options;
  SetOption(InitialiseOptionTable(), "initialise", how, &options);
  return options.initialise;
}

void BindInitialise(py::module_& m) {
  py::enum_<InitialGuess>(m, "InitialGuess", "Where a pose graph's initial values come from.")
      .value("AUTOMATIC", InitialGuess::kAutomatic, "The best of several.")
      .value("FILE", InitialGuess::kFile, "As they are.")
      .value("ODOMETRY", InitialGuess::kOdometry, "Along consecutive keys.")
      .value("SPANNING_TREE", InitialGuess::kSpanningTree, "Breadth first.")
      .value("MINIMUM_SPANNING_TREE", InitialGuess::kMinimumSpanningTree,
             "Of the traces of covariances.")
      .value("CHORDAL", InitialGuess::kChordal, "Rotations, then translations, linear.")
      .value("LAGO", InitialGuess::kLago, "Of the plane: angles, then poses, linear.")
      .value("INCREMENTAL", InitialGuess::kIncremental, "Solved pose by pose.");
  Record<InitialCost>(m, "InitialCost", "What a candidate would begin with.")
      .Field("guess", &InitialCost::guess, "Which.")
      .Field("cost", &InitialCost::cost, "0.5 sum rho(r' W r).");
  Record<InitialiseReport>(m, "InitialiseReport", "What became of the initial values.")
      .Result("used", &InitialiseReport::used, "Which guess.")
      .Result("set", &InitialiseReport::set, "Variables that were given a new value.")
      .Result("poses", &InitialiseReport::poses, "Of these, poses.")
      .Result("landmarks", &InitialiseReport::landmarks, "Of these, landmarks.")
      .Result("roots", &InitialiseReport::roots, "Poses that others were placed from.")
      .Result("free_roots", &InitialiseReport::free_roots, "Roots that nothing holds.")
      .Result("assumed", &InitialiseReport::assumed, "Landmarks at an assumed range.")
      .Result("failure", &InitialiseReport::failure, "Why incremental was given up.")
      .Result("candidates", &InitialiseReport::candidates, "What automatic chose from.")
      .Result("summary", &InitialiseReport::summary, "One line.");
  m.def(
      "initialise",
      [](Graph& graph, const std::string& how, bool file_has_guess) {
        const InitialGuess guess = GuessOf(how);
        return Watched(py::none(), [&](const Observer& watch) {
          return Initialise(&graph, guess, file_has_guess, watch);
        });
      },
      "graph"_a, "how"_a = "automatic", "file_has_guess"_a = true,
      "Gives poses and landmarks of the graph initial values from its measurements.  how: "
      "automatic, file, odometry, spanning_tree, minimum_spanning_tree, chordal, lago, "
      "incremental.");
}

void BindCertify(py::module_& m) {
  py::enum_<Verdict>(m, "Verdict", "What is proved of a solution.")
      .value("OPTIMAL", Verdict::kOptimal, "No poses have a lower cost, but for the gap.")
      .value("BOUNDED", Verdict::kBounded, "A lower bound is proved.")
      .value("REFUSED", Verdict::kRefused, "Not proved.")
      .value("NOT_APPLICABLE", Verdict::kNotApplicable, "The certificate does not cover it.");
  Record<Certificate>(m, "Certificate",
                      "A proof of how far from the global minimum a solution can be at most.")
      .Result("verdict", &Certificate::verdict, "What is proved.")
      .Result("cost", &Certificate::cost, "0.5 sum r' W r at the solution.")
      .Result("lower_bound", &Certificate::lower_bound, "No values have a lower cost.")
      .Result("eigenvalue", &Certificate::eigenvalue, "Where refused: the smallest; nan: unknown.")
      .Result("reasons", &Certificate::reasons, "Where not applicable: why.")
      .Result("exact_factors", &Certificate::exact_factors, "Whose stand-in costs nothing.")
      .Result("factors", &Certificate::factors, "Of all.")
      .Result("factorisations", &Certificate::factorisations, "Sparse ones: the time.")
      .Result("summary", &Certificate::summary, "One line.")
      .Class()
      .def_property_readonly("gap", &Certificate::Gap, "cost - lower_bound")
      .def_property_readonly("relative_gap", &Certificate::RelativeGap, "gap / cost");
  m.def(
      "certify",
      [](const Graph& graph, const Values& values, double optimal_gap, bool find_eigenvalue) {
        const py::gil_scoped_release released;
        return Certify(graph, values, {optimal_gap, find_eigenvalue});
      },
      "graph"_a, "values"_a, "optimal_gap"_a = 1e-5, "find_eigenvalue"_a = true,
      "Certifies values of a pose graph (docs/certificate.md).  A larger relative gap than "
      "`optimal_gap` is BOUNDED.");
}

void BindStarts(py::module_& m) {
  Record<StartedSolve>(m, "StartedSolve", "What came of a start.")
      .Result("start", &StartedSolve::start, "Which.")
      .Result("termination", &StartedSolve::termination, "How it ended.")
      .Result("objective", &StartedSolve::objective, "0.5 sum rho(r' W r) at its end.")
      .Result("iterations", &StartedSolve::iterations, "Steps.")
      .Result("seconds", &StartedSolve::seconds, "Wall: start and solve.");
  Record<SecondLook>(m, "SecondLook",
                     "How a solution that its noise does not explain was looked at again.")
      .Result("reduced_chi2", &SecondLook::reduced_chi2, "Of the first solution.")
      .Result("first", &SecondLook::first, "The first.")
      .Result("certificate", &SecondLook::certificate, "Of the first, or None.")
      .Result("second", &SecondLook::second, "From the incremental start, or None.")
      .Result("improved", &SecondLook::improved, "The solution is the second.")
      .Result("summary", &SecondLook::summary, "One line.");
  py::class_<PoseGraphSolution>(m, "PoseGraphSolution", "A start, and the solve from there.")
      .def_readonly("solution", &PoseGraphSolution::solution, "Values and report.")
      .def_readonly("start", &PoseGraphSolution::start, "Of this solution.")
      .def_readonly("initialise", &PoseGraphSolution::initialise, "Time of all starts together.")
      .def_readonly("second_look", &PoseGraphSolution::second_look, "None: none was taken.");
  m.def(
      "initialise_and_solve",
      [](Graph& graph, const std::string& how, bool file_has_guess, const SolveOptions* options,
         const py::object& on_iteration, const py::kwargs& keywords) {
        const InitialGuess guess = GuessOf(how);
        const SolveOptions chosen = OptionsFrom(options, keywords);
        Graph placed = graph;  // a callback may change the graph itself
        PoseGraphSolution solved = Watched(on_iteration, [&](const Observer& watch) {
          return InitialiseAndSolve(&placed, guess, file_has_guess, chosen, watch);
        });
        graph.SetValues(placed.InitialValues());
        return solved;
      },
      "graph"_a, "how"_a = "automatic", "file_has_guess"_a = true, "options"_a = nullptr,
      py::kw_only(), "on_iteration"_a = py::none(),
      "`initialise`, then `solve`; and where the solution fits worse than its noise allows, from "
      "another start (docs/starts.md): what `graticule solve` does.  The graph's own values are "
      "then those that the solution was found from.");
}

void BindSimulation(py::module_& m) {
  Record<CityOptions>(m, "CityOptions",
                      "A city of square blocks, in which robots drive along the streets.")
      .Field("dimension", &CityOptions::dimension, "2: se2/1; 3: se3/1, on hilly streets.")
      .Field("robots", &CityOptions::robots, "How many.")
      .Field("poses_per_robot", &CityOptions::poses_per_robot, "How many.")
      .Field("blocks", &CityOptions::blocks, "Along each side; 0: as suits.")
      .Field("block_m", &CityOptions::block_m, "Side of a block [m].")
      .Field("step_m", &CityOptions::step_m, "From pose to pose [m].")
      .Field("hill_height_m", &CityOptions::hill_height_m, "Of 3D streets [m].")
      .Field("odometry_sigma_m", &CityOptions::odometry_sigma_m, "[m]")
      .Field("odometry_sigma_rad", &CityOptions::odometry_sigma_rad, "[rad]")
      .Field("closure_sigma_m", &CityOptions::closure_sigma_m, "[m]")
      .Field("closure_sigma_rad", &CityOptions::closure_sigma_rad, "[rad]")
      .Field("closure_range_m", &CityOptions::closure_range_m, "Poses this near may be joined [m].")
      .Field("loops_per_pose", &CityOptions::loops_per_pose, "Closures with the same robot.")
      .Field("inter_robot_per_pose", &CityOptions::inter_robot_per_pose, "With another robot.")
      .Field("loop_min_gap", &CityOptions::loop_min_gap, "Poses between the ends of a loop.")
      .Field("outlier_fraction", &CityOptions::outlier_fraction, "Of the closures.")
      .Field("landmarks", &CityOptions::landmarks, "How many.")
      .Field("landmark_range_m", &CityOptions::landmark_range_m, "[m]")
      .Field("landmark_sigma_m", &CityOptions::landmark_sigma_m, "[m]")
      .Field("sightings_per_pass", &CityOptions::sightings_per_pass, "Chance from a pose.")
      .Field("start_sigma_m", &CityOptions::start_sigma_m, "Of where robots believe to start.")
      .Field("start_sigma_rad", &CityOptions::start_sigma_rad, "[rad]")
      .Field("seed", &CityOptions::seed, "Same options, same digits.");
  py::class_<Simulated>(m, "SimulatedCity", "A pose graph with truth.")
      .def_readonly("graph", &Simulated::graph, "At each robot's odometry.")
      .def_readonly("truth", &Simulated::truth, "Values of the graph's variables.")
      .def_readonly("outliers", &Simulated::outliers, "Ids of closures that are wrong.");
  m.def(
      "simulate_city",
      [](const CityOptions* options, const py::kwargs& keywords) {
        const CityOptions chosen = OptionsFrom(options, keywords);
        const py::gil_scoped_release released;
        return SimulateCity(Builtins(), chosen);
      },
      "options"_a = nullptr,
      "A multi-robot pose graph with truth: families robot1, robot2, ... and landmark.  Options "
      "also as keywords.");
}

}  // namespace

void BindPoseGraph(py::module_& module) {
  Record<InitialiseOptions>(module, "InitialiseOptions", "Where to start from.")
      .Options(InitialiseOptionTable());
  BindInitialise(module);
  BindCertify(module);
  BindStarts(module);
  BindSimulation(module);
}

}  // namespace graticule::python
