#include "bind.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/io/config.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/problem_file.hpp"
#include "graticule/io/trajectory.hpp"
#include "graticule/problems/pose_graph/trajectory_error.hpp"

namespace graticule::python {
namespace {

using namespace py::literals;

Registry TypesOf(const Registry* types) { return types ? *types : Builtins(); }

std::optional<G2oRotation> RotationOf(const std::optional<std::string>& word) {
  if (!word) return std::nullopt;
  const auto rotation = G2oRotationFromWord(*word);
  if (!rotation)
    throw Error("g2o_rotation: expected half, double or full, found '" + *word + "'",
                ErrorKind::kUsage);
  return rotation;
}

// Poses as rows of stamp, x y z, qx qy qz qw.
py::array_t<double> RowsOf(const std::vector<StampedPose>& poses) {
  std::vector<double> rows;
  rows.reserve(8 * poses.size());
  for (const StampedPose& pose : poses) {
    rows.push_back(pose.stamp_s);
    rows.insert(rows.end(), pose.world_from_body.begin(), pose.world_from_body.end());
  }
  return Owned(std::move(rows), {static_cast<py::ssize_t>(poses.size()), 8});
}

std::vector<StampedPose> PosesOf(const Dense<double>& rows) {
  ExpectShape(rows, {-1, 8}, "a trajectory");
  std::vector<StampedPose> poses(static_cast<std::size_t>(rows.shape(0)));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double* row = rows.data(static_cast<py::ssize_t>(i));
    poses[i].stamp_s = row[0];
    std::copy(row + 1, row + 8, poses[i].world_from_body.begin());
  }
  return poses;
}

void BindRecording(py::module_& m) {
  py::class_<RepairedInformation>(m, "RepairedInformation",
                                  "Information matrices that were not positive definite, and "
                                  "were projected.")
      .def("__str__", [](const RepairedInformation& repaired) { return ToString(repaired); });
  py::class_<Recording, std::shared_ptr<Recording>>(
      m, "Recording", "A problem as files carry it: the graph, and where it came from.")
      .def(py::init([](const Graph& graph, const std::string& title) {
             Recording recording(graph.Types());
             recording.graph = graph;
             recording.title = title;
             return recording;
           }),
           "graph"_a, "title"_a = "", "Of a copy of a graph.")
      .def_readwrite("graph", &Recording::graph, "The problem.")
      .def_readwrite("title", &Recording::title, "One line, for people.")
      .def_readwrite("made_by", &Recording::made_by, "Program, version, command.")
      .def_readwrite("frames", &Recording::frames, "The coordinate frames in use, for people.")
      .def_readwrite("solved_by", &Recording::solved_by,
                     "Empty: the values are an initial guess, not a solution.")
      .def_readwrite("report", &Recording::report, "What the solver reported: JSON.")
      .def_property(
          "g2o_rotation",
          [](const Recording& self) -> std::optional<std::string> {
            if (!self.g2o_rotation) return std::nullopt;
            return std::string(ToString(*self.g2o_rotation));
          },
          [](Recording& self, const std::optional<std::string>& word) {
            self.g2o_rotation = RotationOf(word);
          },
          "Which reading of a g2o file's rotations the factors state: half, double, full.")
      .def_readwrite("has_initial_guess", &Recording::has_initial_guess,
                     "False: the values are placeholders, to be initialised first.")
      .def_readonly("skipped", &Recording::skipped, "Tags that were passed over, with counts.")
      .def_readonly("notes", &Recording::notes, "Remarks of the reader.")
      .def_readonly("repaired", &Recording::repaired, "None: nothing had to be repaired.")
      .def("__repr__", [](const py::object& self) {
        return "Recording(" + py::repr(self.attr("graph")).cast<std::string>() +
               ", title=" + py::repr(self.attr("title")).cast<std::string>() + ")";
      });

  m.def(
      "read_problem",
      [](const std::string& path, const Registry* types, bool skip_unknown,
         const std::optional<std::string>& g2o_rotation, bool repair_information) {
        ReadOptions options{skip_unknown, RotationOf(g2o_rotation), repair_information};
        const Registry known = TypesOf(types);
        const py::gil_scoped_release released;
        return ReadProblem(path, known, options);
      },
      "path"_a, "types"_a = nullptr, py::kw_only(), "skip_unknown"_a = false,
      "g2o_rotation"_a = py::none(), "repair_information"_a = false,
      "Reads .fg, .g2o, .graph and .toro, .bal and .txt, each also .gz, told by name or contents. "
      " types: None: the built-in ones.  skip_unknown: lines that are not known are passed over.  "
      "g2o_rotation: half (as g2o), double, full (as GTSAM).  repair_information: matrices that "
      "are not positive definite are projected.");
  m.def(
      "parse_problem",
      [](const std::string& text, const std::string& name, const Registry* types, bool skip_unknown,
         const std::optional<std::string>& g2o_rotation, bool repair_information) {
        ReadOptions options{skip_unknown, RotationOf(g2o_rotation), repair_information};
        return ParseProblem(text, name, TypesOf(types), options);
      },
      "text"_a, "name"_a, "types"_a = nullptr, py::kw_only(), "skip_unknown"_a = false,
      "g2o_rotation"_a = py::none(), "repair_information"_a = false,
      "The same of contents at hand; the format by `name`'s ending, or by the contents.");
  m.def(
      "write_problem",
      [](const std::string& path, const Recording& recording, bool binary) {
        const py::gil_scoped_release released;
        WriteOptions options;
        options.binary = binary;
        return WriteProblem(path, recording, options);
      },
      "path"_a, "recording"_a, "binary"_a = false,
      "Writes a problem in the format that the name says, in one step.  binary: .fg only.  "
      "Returns what the format could not hold, one line each.");
}

void BindTrajectories(py::module_& m) {
  m.def(
      "read_tum", [](const std::string& path) { return RowsOf(ParseTum(ReadFile(path), path)); },
      "path"_a,
      "(n, 8) rows of stamp [s], x y z [m], qx qy qz qw: world_from_body, as the TUM benchmark "
      "has it.");
  m.def(
      "write_tum",
      [](const std::string& path, const Dense<double>& rows) {
        WriteFile(path, FormatTum(PosesOf(rows)));
      },
      "path"_a, "rows"_a, "The same file again, in one step.");
  m.def("pose_families", &PoseFamilies, "graph"_a, "Key families that have poses, in order.");
  m.def(
      "trajectory",
      [](const Graph& graph, const Values* values, const std::string& family) {
        return RowsOf(Trajectory(graph, values ? *values : graph.InitialValues(), family));
      },
      "graph"_a, "values"_a = nullptr, "family"_a = "",
      "(n, 8) rows as `read_tum` has them; the stamp is the key's number, poses of the plane have "
      "z = 0.  values: None: the graph's own.  family: \"\": the only one with poses.");

  Record<ErrorSummary>(m, "ErrorSummary", "An error over all poses, or pairs of them.")
      .Result("count", &ErrorSummary::count, "Poses or pairs.")
      .Result("rmse", &ErrorSummary::rmse, "Root of the mean square.")
      .Result("mean", &ErrorSummary::mean, "Mean.")
      .Result("max", &ErrorSummary::max, "Largest.");
  Record<PoseError>(m, "PoseError", "Of where poses are, and of how they are turned.")
      .Result("translation_m", &PoseError::translation_m, "Metres.")
      .Result("rotation_deg", &PoseError::rotation_deg, "Degrees.");
  Record<FamilyAccuracy>(m, "FamilyAccuracy", "How far poses are from the truth.")
      .Result("family", &FamilyAccuracy::family, "Empty: all together.")
      .Result("poses", &FamilyAccuracy::poses, "How many.")
      .Result("matched", &FamilyAccuracy::matched, "Of these, those whose truth is known.")
      .Result("alignment", &FamilyAccuracy::alignment, "How it was laid onto the truth.")
      .Result("scale", &FamilyAccuracy::scale, "Of the alignment.")
      .Result("ate", &FamilyAccuracy::ate, "Absolute, after alignment.")
      .Result("rpe_step", &FamilyAccuracy::rpe_step, "Relative, from each pose to the next.")
      .Result("rpe_distance", &FamilyAccuracy::rpe_distance, "Relative, over a driven distance.");
  Record<Accuracy>(m, "Accuracy", "Errors of trajectories against the truth.")
      .Result("truth", &Accuracy::truth, "The file that has it.")
      .Result("rpe_distance_m", &Accuracy::rpe_distance_m, "Of rpe_distance [m].")
      .Result("together", &Accuracy::together, "Aligned as one.")
      .Result("families", &Accuracy::families, "Each by itself, where there are several.");
  m.def(
      "trajectory_errors",
      [](const Graph& graph, const Values& values,
         const std::map<std::string, Dense<double>>& truth, double rpe_distance_m) {
        GroundTruth poses;
        for (const auto& [family, rows] : truth) poses[family] = PosesOf(rows);
        TrajectoryErrorOptions options;
        options.rpe_distance_m = rpe_distance_m;
        return TrajectoryErrors(PairWithTruth(graph, values, poses), options);
      },
      "graph"_a, "values"_a, "truth"_a, "rpe_distance_m"_a = 10.0,
      "ATE and RPE as evo defines them, aligned rigidly.  truth: by family, (n, 8) rows as "
      "`read_tum` has them; the stamp is the key's number.");
}

}  // namespace

void BindProblemFiles(py::module_& module) {
  BindRecording(module);
  BindTrajectories(module);
  module.def(
      "read_config",
      [](const std::string& path) {
        py::dict options;
        for (const ConfigEntry& entry : ParseConfig(ReadFile(path), path))
          options[py::str(entry.name)] = entry.value;
        return options;
      },
      "path"_a, "A configuration's options as texts, by name: for solve_configured and compare.");
  module.def(
      "read_file", [](const std::string& path) { return py::bytes(ReadFile(path)); }, "path"_a,
      "The whole of a file; gzip is unpacked.");
  module.def(
      "write_file",
      [](const std::string& path, const py::bytes& contents) {
        WriteFile(path, contents.cast<std::string_view>());
      },
      "path"_a, "contents"_a,
      "Replaces a file's contents in one step; packed where the name ends in .gz.");
}

}  // namespace graticule::python
