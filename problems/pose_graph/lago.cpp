#include "graticule/problems/pose_graph/lago.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "graticule/factors/lie.hpp"
#include "graticule/problems/pose_graph/information.hpp"
#include "graticule/problems/pose_graph/pose_pieces.hpp"
#include "graticule/problems/pose_graph/pose_role.hpp"
#include "graticule/solver/block_system.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

using Scalar = Eigen::Matrix<double, 1, 1>;
constexpr int kHeld = PosePieces::kHeld;

// Of the angle by itself: the inverse of its marginal variance.  0: not measured.
double AngleInformation(Eigen::Matrix3d w) {
  for (int k = 0; k < 2; ++k) {
    if (!(w(k, k) > 0)) continue;
    const Eigen::RowVector3d row = w.row(k);
    w -= row.transpose() * row / row[k];
  }
  return std::max(w(2, 2), 0.0);
}

class Lago {
 public:
  Lago(const Graph& graph, Values* values)
      : graph_(graph), values_(values), order_(graph.KeyOrder()), yaw_(graph.VariableCount()) {
    for (const VariableType& type : graph.UsedVariableTypes())
      is_pose_.push_back(type.name == "se2/1");
    for (const VariableId id : order_) {
      if (graph.TypeOf(id).name == "se3/1")
        throw Error("initialise: lago is for poses of the plane (se2/1), and " +
                        graph.KeyOf(id).ToString() + " is in space (se3/1); take chordal",
                    ErrorKind::kUsage);
      if (IsPose(id)) yaw_[id] = (*values)[id][2];
    }
    Collect();
  }

  void Run(LagoReport* report) {
    report->kept_pieces = pieces_.kept;
    if (pieces_.poses.empty()) return;
    const int nodes = static_cast<int>(pieces_.poses.size());
    BlockSystem angles(1, nodes, links_);
    if (!SolveAngles(&angles) || !SolvePoses(&angles)) {
      report->kept_pieces += pieces_.solved;
      return;
    }
    report->poses = pieces_.poses.size();
  }

 private:
  // A between factor, or with a == Layout::kNone a prior: b seen from the world.
  struct Measurement {
    VariableId a, b;
    Eigen::Vector3d measured;
    Eigen::Matrix3d w;
    double turn = 0;       // by which its angle misses, its whole turns settled
    std::size_t link = 0;  // where both ends are free
    bool IsPrior() const { return a == Layout::kNone; }
  };

  bool IsPose(VariableId id) const { return is_pose_[graph_.VariableTypeIndex(id)]; }
  int Node(VariableId id) const { return id == Layout::kNone ? kHeld : pieces_.index[id]; }

  void Collect() {
    std::vector<PoseTie> ties;
    std::vector<PoseAnchor> anchors;
    for (FactorId id = 0; id < graph_.FactorCount(); ++id) {
      const FactorView factor = graph_.FactorAt(id);
      const PoseRole role = PoseRoleOf(factor.type->name);
      if (role != PoseRole::kBetween && role != PoseRole::kPrior) continue;
      const bool between = role == PoseRole::kBetween;
      Measurement sum{between ? factor.variables[0] : Layout::kNone,
                      factor.variables[between ? 1 : 0],
                      Eigen::Map<const Eigen::Vector3d>(factor.measurement.data()),
                      InformationOf<3>(factor.noise)};
      // Over the tree's own edges the angles agree; over the others this rounds the cycle's turns.
      sum.turn = WrapAngle(yaw_[sum.b] - (between ? yaw_[sum.a] : 0.0) - sum.measured[2]);
      const bool is_whole = std::isfinite(TraceOfInverse(sum.w));
      if (between)
        ties.push_back({sum.a, sum.b, is_whole});
      else
        anchors.push_back({sum.b, is_whole});
      measurements_.push_back(sum);
    }
    pieces_ = FindPosePieces(graph_, order_, is_pose_, ties, anchors);
    for (Measurement& sum : measurements_) {
      sum.link = links_.size();
      if (Node(sum.a) != kHeld && Node(sum.b) != kHeld)
        links_.emplace_back(Node(sum.a), Node(sum.b));
    }
  }

  bool SolveAngles(BlockSystem* system) {
    std::vector<double> by(pieces_.poses.size());
    for (const Measurement& sum : measurements_) {
      const int a = Node(sum.a), b = Node(sum.b);
      const double weight = AngleInformation(sum.w);
      if (a != kHeld) {
        system->AddToNode(a, Scalar(weight));
        by[static_cast<std::size_t>(a)] += weight * sum.turn;
      }
      if (b != kHeld) {
        system->AddToNode(b, Scalar(weight));
        by[static_cast<std::size_t>(b)] -= weight * sum.turn;
      }
      if (a != kHeld && b != kHeld) system->AddToLink(sum.link, Scalar(-weight));
    }
    if (!system->Solve(&by, 1)) return false;
    const auto moved = [&](VariableId id) {
      return Node(id) == kHeld ? 0.0 : by[static_cast<std::size_t>(Node(id))];
    };
    for (Measurement& sum : measurements_) sum.turn += moved(sum.b) - moved(sum.a);
    for (const VariableId id : pieces_.poses) yaw_[id] += moved(id);
    return true;
  }

  bool SolvePoses(const BlockSystem* ordered_like) {
    BlockSystem system(3, static_cast<int>(pieces_.poses.size()), links_, ordered_like);
    std::vector<double> by(3 * pieces_.poses.size());
    const auto push = [&](int node, const Eigen::Vector3d& force) {
      Eigen::Map<Eigen::Vector3d>(by.data() + 3 * node) -= force;
    };
    for (const Measurement& sum : measurements_) {
      const int a = Node(sum.a), b = Node(sum.b);
      if (a == kHeld && b == kHeld) continue;
      const Eigen::Rotation2Dd from(sum.IsPrior() ? 0.0 : yaw_[sum.a]), turn(sum.measured[2]);
      const Eigen::Matrix2d to_b = (from * turn).inverse().toRotationMatrix();
      const Eigen::Vector2d ahead = from * Eigen::Vector2d(sum.measured.head<2>());
      Eigen::Vector3d residual;
      residual << to_b * (PositionOf(sum.b) - PositionOf(sum.a) - ahead), sum.turn;
      // Of the residual by the ends' moves: `ahead` turns with a.
      Eigen::Matrix3d by_a = Eigen::Matrix3d::Zero(), by_b = Eigen::Matrix3d::Zero();
      by_b.topLeftCorner<2, 2>() = to_b;
      by_b(2, 2) = 1;
      by_a = -by_b;
      by_a.topRightCorner<2, 1>() = -to_b * Eigen::Vector2d(-ahead[1], ahead[0]);
      if (a != kHeld) {
        system.AddToNode(a, Eigen::Matrix3d(by_a.transpose() * sum.w * by_a));
        push(a, by_a.transpose() * (sum.w * residual));
      }
      if (b != kHeld) {
        system.AddToNode(b, Eigen::Matrix3d(by_b.transpose() * sum.w * by_b));
        push(b, by_b.transpose() * (sum.w * residual));
      }
      if (a != kHeld && b != kHeld)
        system.AddToLink(sum.link, Eigen::Matrix3d(by_a.transpose() * sum.w * by_b));
    }
    if (!system.Solve(&by, 1)) return false;
    for (std::size_t i = 0; i < pieces_.poses.size(); ++i) {
      const VariableId id = pieces_.poses[i];
      double* pose = values_->Mutable(id);
      pose[0] += by[3 * i];
      pose[1] += by[3 * i + 1];
      pose[2] = WrapAngle(yaw_[id] + by[3 * i + 2]);
    }
    return true;
  }

  Eigen::Vector2d PositionOf(VariableId id) const {
    if (id == Layout::kNone) return Eigen::Vector2d::Zero();
    return Eigen::Map<const Eigen::Vector2d>((*values_)[id].data());
  }

  const Graph& graph_;
  Values* values_;
  std::vector<VariableId> order_;
  std::vector<bool> is_pose_;  // by variable type
  std::vector<double> yaw_;    // by variable
  std::vector<Measurement> measurements_;
  PosePieces pieces_;
  std::vector<std::pair<int, int>> links_;
};

}  // namespace

LagoReport PlaceByLago(const Graph& graph, Values* values) {
  LagoReport report;
  Lago(graph, values).Run(&report);
  report.landmarks = PlaceLandmarks(graph, values);
  return report;
}

}  // namespace graticule
