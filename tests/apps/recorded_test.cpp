// Recorded problems, whole: from the file through the solver into files and back.  Costs are held
// against the best known ones, which several solvers agree on (shared/data/posegraph/MANIFEST.md).

#include <algorithm>
#include <cmath>
#include <iterator>

#include "command.hpp"

namespace graticule::test {
namespace {

// Below this a cost is rounding: nothing is left to compare relatively.
constexpr double kNoCost = 1e-12;

struct Problem {
  const char* file;
  const char* ending;      // of its own format
  double best_known;       // 0.5 r'Wr
  bool is_relaxed = true;  // chordal and lago lead there
};

void PrintTo(const Problem& problem, std::ostream* out) { *out << problem.file; }

// MANIFEST.md gives its costs to six digits or more; 1e-4 also bears its remarks "not settled".
const Problem kProblems[] = {
    {"CSAIL.g2o", ".g2o", 20.2775644},
    {"M3500.g2o", ".g2o", 68.9564755},
    {"city10000.g2o.gz", ".g2o", 255.992582},
    {"intel.g2o", ".g2o", 22.5023479},
    {"kitti_00.g2o", ".g2o", 49.1610059},
    {"manhattan.g2o", ".g2o", 1774.5184},
    {"manhattanOlson3500.g2o", ".g2o", 73.0383725},
    {"parking-garage.g2o", ".g2o", 0.61934529},
    {"ring.g2o", ".g2o", 5.58155042},
    {"smallGrid3D.g2o", ".g2o", 229.076893},
    {"sphere2500.g2o", ".g2o", 363.574834},
    {"sphere_bignoise_vertex3.g2o.gz", ".g2o", 371931.36},
    {"tinyGrid3D.g2o", ".g2o", 3.36394083},
    {"synth-problem-49-7776-pre.txt.gz", ".txt", 8013.91747},
    // Exact to begin with: GTSAM's example of a file whose observations were made from its answer.
    {"gtsam_dubrovnik-3-7-pre.txt", ".txt", 0},
    // Not in the manifest: measured here, the same with every configuration.
    {"gtsam_w100.graph", ".graph", 0.568912592},
    {"MIT.g2o", ".g2o", 20.5816344},
    {"torus3D.g2o.gz", ".g2o", 7287.37323},
    // Long odometry and 151 landmarks: chordal ends at 60009.  Proved optimal, see certificate.md.
    {"victoria_park.g2o", ".g2o", 3092.06013, false},
};

bool SameCost(double a, double b) {
  return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b)) ||
         std::max(std::abs(a), std::abs(b)) < kNoCost;
}

class RecordedProblem : public RecordedTest, public testing::WithParamInterface<Problem> {};

TEST_P(RecordedProblem, IsSolvedWrittenAndReadAgainAtTheSameCost) {
  const Problem& problem = GetParam();
  const Outcome solved = RunCommand(
      {"solve", Recorded(problem.file), "--json", "-o", Path(std::string("own") + problem.ending)});
  const auto report = JsonOf(solved);
  ASSERT_TRUE(report.contains("final_cost")) << solved.err;
  const double cost = report["final_cost"];
  EXPECT_LE(cost, report["initial_cost"]);
  EXPECT_EQ(solved.exit_code, 0);
  EXPECT_EQ(report["termination"], "converged");
  EXPECT_NEAR(cost, problem.best_known, 1e-4 * problem.best_known + kNoCost);
  // These two alone do not fit as their noise says at first: the others cost what they did.
  const std::string file = problem.file;
  EXPECT_EQ(report.contains("second_look"),
            file == "victoria_park.g2o" || file == "sphere_bignoise_vertex3.g2o.gz");

  const std::string own = Path(std::string("own") + problem.ending);
  ASSERT_EQ(RunCommand({"convert", own, Path("text.fg")}).exit_code, 0);
  ASSERT_EQ(RunCommand({"convert", own, Path("binary.fg"), "--binary"}).exit_code, 0);
  for (const std::string& file : {own, Path("text.fg"), Path("binary.fg")}) {
    const Outcome again = RunCommand({"solve", file, "--json", "--set", "max_iterations=0"});
    const auto reread = JsonOf(again);
    ASSERT_TRUE(reread.contains("initial_cost")) << file << ": " << again.err;
    EXPECT_TRUE(SameCost(reread["initial_cost"], cost))
        << file << ": " << reread["initial_cost"] << " where " << cost << " was written";
    EXPECT_EQ(reread["variables"], report["variables"]);
    EXPECT_EQ(reread["factors"], report["factors"]);
  }
}

std::string NameOf(const testing::TestParamInfo<Problem>& info) {
  std::string name = info.param.file;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Problems, RecordedProblem, testing::ValuesIn(kProblems), NameOf);

class Engines : public RecordedTest, public testing::WithParamInterface<Problem> {};

TEST_P(Engines, ReachTheSameCost) {
  const Problem& problem = GetParam();
  const auto cost = [&](const char* engine) {
    // So close to the minimum that what is left of the way there is no difference.
    const auto report = JsonOf(RunCommand({"solve", Recorded(problem.file), "--json", "--set",
                                           engine, "--set", "function_tolerance=1e-13"}));
    return report.value("final_cost", std::nan(""));
  };
  const double ceres = cost("engine=ceres"), direct = cost("engine=direct");
  EXPECT_TRUE(SameCost(ceres, direct)) << ceres << " with Ceres, " << direct << " without";
}

std::vector<Problem> Settled() {
  std::vector<Problem> settled;
  for (const Problem& problem : kProblems)
    if (std::string(problem.ending) != ".txt") settled.push_back(problem);
  return settled;
}

INSTANTIATE_TEST_SUITE_P(Problems, Engines, testing::ValuesIn(Settled()), NameOf);

class G2oRotations : public RecordedTest {};

// The manifest's third column lies up to 9.3e-5 above what is reached here (sphere2500 675.681164,
// torus3D 12116.5093; computed again outside this program from the written file).
TEST_F(G2oRotations, EachReachTheBestKnownCostOfTheirReading) {
  const struct {
    const char* file;
    double half, twice, full;
  } files[] = {
      {"parking-garage.g2o", 0.61934529, 0.634192192, 0.6341924},
      {"sphere2500.g2o", 363.574834, 675.607873, 675.700963},
      {"torus3D.g2o.gz", 7287.37323, 12113.5228, 12117.6369},
  };
  for (const auto& file : files) {
    const std::pair<const char*, double> readings[] = {
        {"half", file.half}, {"double", file.twice}, {"full", file.full}};
    for (const auto& [rotation, best_known] : readings) {
      const Outcome solved =
          RunCommand({"solve", Recorded(file.file), "--g2o-rotation", rotation, "--json"});
      EXPECT_EQ(solved.exit_code, 0) << file.file << " " << rotation;
      const double cost = JsonOf(solved).value("final_cost", 0.0);
      EXPECT_LE(cost, best_known * (1 + 1e-6)) << file.file << " " << rotation;
      EXPECT_GE(cost, best_known * (1 - 1e-4)) << file.file << " " << rotation;
    }
  }
}

TEST_F(G2oRotations, AreKeptInWhatIsWritten) {
  for (const char* name : {"a.fg", "a.g2o"}) {
    ASSERT_EQ(
        RunCommand({"convert", Recorded("tinyGrid3D.g2o"), Path(name), "--g2o-rotation", "full"})
            .exit_code,
        0);
    const auto said = JsonOf(
        RunCommand({"solve", Recorded("tinyGrid3D.g2o"), "--g2o-rotation", "full", "--json"}));
    const auto kept = JsonOf(RunCommand({"solve", Path(name), "--json"}));
    EXPECT_EQ(said["final_cost"], kept["final_cost"]) << name;
  }
}

class Start : public RecordedTest {};

TEST_F(Start, OfTheFileLeadsElsewhereWhereItIsPoor) {
  // A hundred iterations end far above, a few show as much.
  const std::pair<const char*, double> files[] = {{"MIT.g2o", 20.5816344},
                                                  {"torus3D.g2o.gz", 7287.37323}};
  for (const auto& [file, best_known] : files) {
    const Outcome solved = RunCommand({"solve", Recorded(file), "--set", "initialise=file", "--set",
                                       "max_iterations=10", "--json"});
    EXPECT_EQ(solved.exit_code, 4) << file;
    EXPECT_EQ(JsonOf(solved)["termination"], "no_convergence") << file;
    EXPECT_GT(JsonOf(solved).value("final_cost", 0.0), 1.5 * best_known) << file;
  }
}

// The poses that no tree reaches well: sphere_bignoise ends at 428119 from one.
TEST_F(Start, ChordalLeadsToTheBestKnownCostEverywhere) {
  for (const Problem& problem : kProblems) {
    const std::string file = problem.file;
    if (!problem.is_relaxed || file.find(".txt") != std::string::npos) continue;
    const Outcome solved =
        RunCommand({"solve", Recorded(file), "--set", "initialise=chordal", "--json"});
    EXPECT_EQ(solved.exit_code, 0) << file;
    const auto report = JsonOf(solved);
    EXPECT_NEAR(report.value("final_cost", 0.0), problem.best_known, 1e-4 * problem.best_known)
        << file;
    // Measured: at most 11 (parking-garage, whose cost the start is within 15 % of).
    EXPECT_LE(report.value("iterations", 100), 12) << file;
    EXPECT_EQ(report.value("initialisation", "").rfind("chordal: ", 0), 0u) << file;
  }
}

TEST_F(Start, LagoLeadsToTheBestKnownCostEverywhereInThePlane) {
  for (const Problem& problem : kProblems) {
    const std::string file = problem.file;
    const auto what = JsonOf(RunCommand({"inspect", Recorded(file), "--json"}));
    if (!problem.is_relaxed || what["families"][0]["type"] != "se2/1") continue;
    const Outcome solved =
        RunCommand({"solve", Recorded(file), "--set", "initialise=lago", "--json"});
    EXPECT_EQ(solved.exit_code, 0) << file;
    const auto report = JsonOf(solved);
    EXPECT_NEAR(report.value("final_cost", 0.0), problem.best_known, 1e-6 * problem.best_known)
        << file;
    // Measured: at most 5 (MIT).
    EXPECT_LE(report.value("iterations", 100), 6) << file;
    EXPECT_EQ(report.value("initialisation", "").rfind("lago: ", 0), 0u) << file;
  }
}

// All of them, in a minute: the quickest.
TEST_F(Start, IncrementalLeadsToTheBestKnownCost) {
  for (const char* name : {"MIT.g2o", "CSAIL.g2o", "intel.g2o", "ring.g2o", "kitti_00.g2o",
                           "smallGrid3D.g2o", "tinyGrid3D.g2o", "victoria_park.g2o"}) {
    const auto problem =
        std::find_if(std::begin(kProblems), std::end(kProblems),
                     [&](const Problem& p) { return p.file == std::string(name); });
    const Outcome solved =
        RunCommand({"solve", Recorded(name), "--set", "initialise=incremental", "--json"});
    EXPECT_EQ(solved.exit_code, 0) << name;
    const auto report = JsonOf(solved);
    EXPECT_NEAR(report.value("final_cost", 0.0), problem->best_known, 1e-6 * problem->best_known)
        << name;
    // Measured: at most 5, and that where there are 9 and 125 poses in all.
    EXPECT_LE(report.value("iterations", 100), 6) << name;
    EXPECT_EQ(report.value("initialisation", "").rfind("incremental: ", 0), 0u) << name;
  }
}

class SecondLook : public RecordedTest {};

TEST_F(SecondLook, LeadsVictoriaParkToItsOptimum) {
  const Outcome solved = RunCommand({"solve", Recorded("victoria_park.g2o"), "--certify", "--json",
                                     "--report", Path("report.html")});
  const auto report = JsonOf(solved);
  EXPECT_EQ(report["certificate"]["verdict"], "optimal");
  EXPECT_TRUE(report["certificate"]["attempts"].empty());
  EXPECT_NEAR(report["final_cost"], 3092.06013, 1e-4);
  const auto& look = report["second_look"];
  EXPECT_EQ(look["first"]["start"], "chordal");
  EXPECT_NEAR(look["first"]["objective"], 60009.2398, 1);
  EXPECT_EQ(look["verdict"], "refused");
  EXPECT_EQ(look["second"]["start"], "incremental");
  EXPECT_EQ(look["second"]["objective"], report["final_objective"]);
  EXPECT_EQ(look["improved"], true);
  EXPECT_EQ(look["stopped"], false);
  EXPECT_EQ(report.value("initialisation", "").rfind("incremental: ", 0), 0u);
  EXPECT_NE(ReadWhole(Path("report.html")).find(look["text"]), std::string::npos);
}

TEST_F(SecondLook, EndsWithTheProofOfSphereBignoise) {
  const auto report =
      JsonOf(RunCommand({"solve", Recorded("sphere_bignoise_vertex3.g2o.gz"), "--json"}));
  EXPECT_EQ(report["second_look"]["verdict"], "optimal");
  EXPECT_TRUE(report["second_look"]["second"].is_null());
  EXPECT_EQ(report["second_look"]["improved"], false);
}

TEST_F(SecondLook, KeepsTheFirstSolutionOnCtrlC) {
  RunOptions interrupted;
  interrupted.terminal_stderr = true;
  interrupted.interrupt_at = "iteration 2, objective 60009.";
  const Outcome solved = RunCommand(
      {"solve", Recorded("victoria_park.g2o"), "--json", "-o", Path("out.g2o")}, interrupted);
  EXPECT_EQ(solved.exit_code, 0);
  const auto report = JsonOf(solved);
  EXPECT_EQ(report["second_look"]["stopped"], true);
  EXPECT_EQ(report["second_look"]["improved"], false);
  EXPECT_NEAR(report["final_cost"], 60009.2398, 1);
  const auto again =
      JsonOf(RunCommand({"solve", Path("out.g2o"), "--json", "--set", "max_iterations=0"}));
  EXPECT_TRUE(SameCost(again["initial_cost"], report["final_cost"]));
}

TEST_F(Start, IncrementalIsLeftOnCtrlCWithWhatItHas) {
  RunOptions interrupted;
  interrupted.terminal_stderr = true;
  interrupted.interrupt_at = "iteration 5, ";
  const Outcome solved = RunCommand({"solve", Recorded("victoria_park.g2o"), "--json", "--set",
                                     "initialise=incremental", "-o", Path("out.g2o")},
                                    interrupted);
  EXPECT_EQ(solved.exit_code, 4);
  const auto report = JsonOf(solved);
  EXPECT_EQ(report["termination"], "cancelled");
  EXPECT_NE(report.value("initialisation", "").find("then given up: stopped"), std::string::npos);
  EXPECT_EQ(Files(), std::vector<std::string>{"out.g2o"});
}

TEST_F(Start, LagoIsRefusedInSpace) {
  const Outcome solved = RunCommand(
      {"solve", Recorded("tinyGrid3D.g2o"), "--set", "initialise=lago", "-o", Path("out.g2o")});
  EXPECT_EQ(solved.exit_code, 2);
  EXPECT_EQ(solved.err.rfind("graticule: initialise: lago is for poses of the plane", 0), 0u)
      << solved.err;
  EXPECT_TRUE(Files().empty());
}

TEST_F(Start, SpanningTreesLeadThereMostly) {
  for (const char* tree : {"spanning_tree", "minimum_spanning_tree"}) {
    const std::pair<const char*, double> files[] = {{"MIT.g2o", 20.5816344},
                                                    {"torus3D.g2o.gz", 7287.37323}};
    for (const auto& [file, best_known] : files) {
      const Outcome solved = RunCommand(
          {"solve", Recorded(file), "--set", std::string("initialise=") + tree, "--json"});
      EXPECT_EQ(solved.exit_code, 0) << file << " " << tree;
      EXPECT_NEAR(JsonOf(solved).value("final_cost", 0.0), best_known, 1e-6 * best_known)
          << file << " " << tree;
    }
  }
}

TEST_F(Start, OfASolvedFileIsKept) {
  for (const char* file : {"intel.g2o", "parking-garage.g2o", "smallGrid3D.g2o"}) {
    const auto first =
        JsonOf(RunCommand({"solve", Recorded(file), "-o", Path("solved.g2o"), "--json"}));
    const auto again = JsonOf(RunCommand({"solve", Path("solved.g2o"), "--json"}));
    EXPECT_EQ(again.value("initialisation", "").rfind("file: ", 0), 0u) << file;
    EXPECT_NEAR(again.value("final_cost", 0.0), first.value("final_cost", 1.0),
                1e-6 * first.value("final_cost", 1.0))
        << file;
  }
}

}  // namespace
}  // namespace graticule::test
