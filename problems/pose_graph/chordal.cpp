#include "graticule/problems/pose_graph/chordal.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include "graticule/factors/lie.hpp"
#include "graticule/problems/pose_graph/block_system.hpp"
#include "graticule/problems/pose_graph/information.hpp"
#include "graticule/problems/pose_graph/nearest_rotation.hpp"
#include "graticule/problems/pose_graph/pose_role.hpp"
#include "graticule/problems/pose_graph/transform.hpp"
#include "graticule/problems/pose_graph/union_find.hpp"

namespace graticule {
namespace {

constexpr int kHeld = -1;
constexpr std::uint32_t kWorld = 0;  // group of everything that something ties to the world
constexpr std::uint32_t kNoGroup = 0xffffffffu;

// All poses and landmarks of the plane (2) or of space (3).
template <int kDim>
class Relaxation {
 public:
  Relaxation(const Graph& graph, Values* values)
      : graph_(graph), values_(values), order_(graph.KeyOrder()) {
    const char* pose = kPlanar ? "se2/1" : "se3/1";
    for (const VariableType& type : graph.UsedVariableTypes())
      pose_type_.push_back(type.name == pose);
    for (const FactorType& type : graph.UsedFactorTypes()) roles_.push_back(RoleOf(type));
    Collect();
    FindPieces();
  }

  // False where CHOLMOD found no solution; then nothing has changed.
  bool Run(ChordalReport* report) {
    report->kept_pieces += kept_;
    report->pieces += solved_;
    if (poses_.empty()) return true;
    BlockSystem system(kDim, static_cast<int>(poses_.size()), links_);
    std::vector<Pose> before;
    for (const VariableId id : poses_) before.push_back(PoseAt(id));
    if (!SolveRotations(&system) || !SolveTranslations(&system)) {
      for (std::size_t i = 0; i < poses_.size(); ++i) Write(poses_[i], before[i]);
      report->pieces -= solved_;
      report->kept_pieces += solved_;
      landmarks_.clear();
      return false;
    }
    report->poses += poses_.size();
    return true;
  }

  // The landmarks that the translations brought with them, onto `values`.
  void WriteLandmarks(Values* values) const {
    for (const auto& [id, point] : placed_landmarks_)
      std::copy_n(point.data(), kDim, values->Mutable(id));
  }

 private:
  static constexpr bool kPlanar = kDim == 2;
  static constexpr int kTurn = kPlanar ? 1 : 3;  // numbers of a rotation's residual
  // Rows of R that are solved for: in the plane the second follows from the first.
  static constexpr int kRows = kPlanar ? 1 : 3;
  using Matrix = Eigen::Matrix<double, kDim, kDim>;
  using Vector = Eigen::Matrix<double, kDim, 1>;
  using Scalar = Eigen::Matrix<double, 1, 1>;
  using Turn = Eigen::Matrix<double, kTurn, 1>;
  using Information = Eigen::Matrix<double, kDim + kTurn, kDim + kTurn>;

  struct Pose {
    double stored[kPlanar ? 3 : 7];
    Matrix rotation;
    Vector Translation() const { return Eigen::Map<const Vector>(stored); }
  };
  struct Edge {
    FactorId factor;
    VariableId a, b;
    Pose measured;
    double kappa = 0;
    std::size_t link = 0;   // where both ends are free
    bool is_whole = false;  // it says all of a pose
  };
  struct Prior {
    FactorId factor;
    VariableId pose;
    double kappa = 0;
  };

  // What is said of the other dimension is none of our business.
  static PoseRole RoleOf(const FactorType& type) {
    const bool planar = type.name.find("se2/") != std::string::npos ||
                        type.name.find("point2/") != std::string::npos;
    return planar == kPlanar ? PoseRoleOf(type.name) : PoseRole::kOther;
  }
  PoseRole RoleOf(FactorId id) const { return roles_[graph_.FactorTypeIndex(id)]; }
  bool IsPose(VariableId id) const { return pose_type_[graph_.VariableTypeIndex(id)]; }

  static Pose PoseFrom(const double* given) {
    Pose pose;
    CopyPose(kPlanar, given, pose.stored);
    if constexpr (kPlanar) {
      const double c = std::cos(pose.stored[2]), s = std::sin(pose.stored[2]);
      pose.rotation << c, -s, s, c;
    } else {
      RowMajor<3, 3> rotation;
      QuaternionToMatrix(pose.stored + 3, rotation.data());
      pose.rotation = rotation;
    }
    return pose;
  }
  Pose PoseAt(VariableId id) const { return PoseFrom((*values_)[id].data()); }
  void Write(VariableId id, const Pose& pose) {
    std::copy_n(pose.stored, PoseSize(kPlanar), values_->Mutable(id));
  }
  Vector PointAt(VariableId id) const { return Eigen::Map<const Vector>((*values_)[id].data()); }

  Information InformationOfFactor(const FactorView& factor) const {
    return InformationOf<kDim + kTurn>(factor.noise);
  }

  double Kappa(const FactorView& factor, const Information& information) const {
    const double trace = TraceOfInverse(Eigen::Matrix<double, kTurn, kTurn>(
        information.template bottomRightCorner<kTurn, kTurn>()));
    const double whole_angle = IsHalfAngle(factor.type->name) ? 0.25 : 1;
    return std::isfinite(trace) ? whole_angle * kTurn / trace : 0;
  }

  void Collect() {
    for (FactorId id = 0; id < graph_.FactorCount(); ++id) {
      const PoseRole role = RoleOf(id);
      const FactorView factor = graph_.FactorAt(id);
      if (role == PoseRole::kBetween) {
        const Information information = InformationOfFactor(factor);
        Edge edge{id, factor.variables[0], factor.variables[1],
                  PoseFrom(factor.measurement.data())};
        edge.kappa = Kappa(factor, information);
        const Matrix w = information.template topLeftCorner<kDim, kDim>();
        edge.is_whole = edge.kappa > 0 && std::isfinite(TraceOfInverse(w));
        isotropic_ = isotropic_ && w == Matrix(w(0, 0) * Matrix::Identity());
        edges_.push_back(edge);
      } else if (role == PoseRole::kPrior || role == PoseRole::kPriorWithOffset) {
        priors_.push_back({id, factor.variables[0], 0});
      } else if (role != PoseRole::kOther) {
        others_.push_back(id);
      }
    }
  }

  // Sorts poses into pieces, decides which are held, and numbers the others in key order.
  void FindPieces() {
    const auto count = static_cast<std::uint32_t>(graph_.VariableCount());
    UnionFind pieces(count), whole(count + 1);  // `whole`: over factors that say all; + the world
    for (const Edge& edge : edges_) {
      pieces.Join(edge.a, edge.b);
      if (edge.is_whole) whole.Join(edge.a, edge.b);
    }
    std::vector<std::uint8_t> has_world(count), is_kept(count), counted(count);
    std::vector<VariableId> gauge(count, Layout::kNone);  // by piece
    for (const VariableId id : order_) {
      if (!IsPose(id) || !graph_.IsFixed(id)) continue;
      has_world[pieces.Root(id)] = 1;
      whole.Join(id, count);
    }
    std::vector<std::uint8_t> has_prior(count);
    for (Prior& prior : priors_) {
      const FactorView factor = graph_.FactorAt(prior.factor);
      const Information information = InformationOfFactor(factor);
      prior.kappa = Kappa(factor, information);
      has_prior[prior.pose] = 1;
      if (prior.kappa == 0 ||
          !std::isfinite(TraceOfInverse(Matrix(information.template topLeftCorner<kDim, kDim>()))))
        continue;
      has_world[pieces.Root(prior.pose)] = 1;
      whole.Join(prior.pose, count);
    }
    for (const bool with_prior : {true, false})
      for (const VariableId id : order_) {
        VariableId& held = gauge[pieces.Root(id)];
        if (!IsPose(id) || has_world[pieces.Root(id)] || held != Layout::kNone) continue;
        if (with_prior && !has_prior[id]) continue;
        held = id;
        whole.Join(id, count);
      }
    for (const VariableId id : order_)
      if (IsPose(id) && whole.Root(id) != whole.Root(count)) is_kept[pieces.Root(id)] = 1;

    index_.assign(count, kHeld);
    group_.assign(count, kNoGroup);
    for (const VariableId id : order_) {
      if (!IsPose(id)) continue;
      const std::uint32_t piece = pieces.Root(id);
      group_[id] = has_world[piece] ? kWorld : 1 + piece;
      if (!counted[piece]++) ++(is_kept[piece] ? kept_ : solved_);
      if (is_kept[piece] || graph_.IsFixed(id) || gauge[piece] == id) continue;
      index_[id] = static_cast<int>(poses_.size());
      poses_.push_back(id);
    }
    for (Edge& edge : edges_) {
      edge.link = links_.size();
      if (index_[edge.a] != kHeld && index_[edge.b] != kHeld)
        links_.emplace_back(index_[edge.a], index_[edge.b]);
    }
  }

  // --- rotations

  bool SolveRotations(BlockSystem* system) {
    rotations_.resize(graph_.VariableCount());
    for (const VariableId id : order_)
      if (IsPose(id)) rotations_[id] = PoseAt(id).rotation;
    // The rows of R stand as columns: kappa |x_b - R_ab' x_a|^2 each, x the change from the tree's.
    const int size = kDim * static_cast<int>(poses_.size());
    std::vector<double> rhs(static_cast<std::size_t>(size * kRows));
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, kRows>> x(rhs.data(), size, kRows);
    const auto add = [&](int node, double kappa, const Matrix& right) {
      system->AddToNode(node, Matrix(kappa * Matrix::Identity()));
      x.template middleRows<kDim>(kDim * node) += kappa * right.template leftCols<kRows>();
    };
    for (const Edge& edge : edges_) {
      const int a = index_[edge.a], b = index_[edge.b];
      if (edge.kappa == 0 || (a == kHeld && b == kHeld)) continue;
      const Matrix& turn = edge.measured.rotation;
      const Matrix missing = (rotations_[edge.a] * turn - rotations_[edge.b]).transpose();
      if (a != kHeld) add(a, edge.kappa, -turn * missing);
      if (b != kHeld) add(b, edge.kappa, missing);
      if (a != kHeld && b != kHeld) system->AddToLink(edge.link, Matrix(-edge.kappa * turn));
    }
    for (const Prior& prior : priors_) {
      const int node = index_[prior.pose];
      if (prior.kappa == 0 || node == kHeld) continue;
      const FactorView factor = graph_.FactorAt(prior.factor);
      Matrix rotation = PoseFrom(factor.measurement.data()).rotation;
      if (RoleOf(prior.factor) == PoseRole::kPriorWithOffset)
        rotation = rotation * PoseFrom(factor.measurement.data() + 7).rotation.transpose();
      add(node, prior.kappa, (rotation - rotations_[prior.pose]).transpose());
    }
    if (!system->Solve(&rhs, kRows)) return false;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      Matrix& rotation = rotations_[poses_[i]];
      Matrix relaxed = rotation;
      relaxed.template topRows<kRows>() +=
          x.template middleRows<kDim>(kDim * static_cast<int>(i)).transpose();
      double* pose = values_->Mutable(poses_[i]);
      if constexpr (kPlanar) {
        pose[2] = WrapAngle(std::atan2(-relaxed(0, 1), relaxed(0, 0)));
        const double norm = std::hypot(relaxed(0, 0), relaxed(0, 1));
        if (!(norm > 0)) return false;
        relaxed /= norm;
        rotation << relaxed(0, 0), relaxed(0, 1), -relaxed(0, 1), relaxed(0, 0);
      } else {
        NearestRotation(relaxed, pose + 3);
        rotation = PoseAt(poses_[i]).rotation;
      }
    }
    return true;
  }

  // --- translations

  // The residual of a rotation as the factor states it: what couples with the translation's.
  static Turn TurnBetween(const FactorView& factor, const double* measured, const double* reached) {
    Turn turn;
    if constexpr (kPlanar) {
      turn[0] = WrapAngle(reached[2] - measured[2]);
    } else {
      double error[4];
      QuaternionInverseProduct(measured + 3, reached + 3, error);
      if (IsHalfAngle(factor.type->name))
        VectorPart::Evaluate(error, turn.data(), nullptr);
      else
        RotationVector::Evaluate(error, turn.data(), nullptr);
    }
    return turn;
  }

  // The normal equations.  Where every information is a multiple of one (`is_scalar`), the axes do
  // not mix: one number a node, and a right-hand side an axis.
  struct Translations {
    BlockSystem* system;
    bool is_scalar;
    std::vector<double> rhs;
    std::size_t node_stride, axis_stride;

    Translations(BlockSystem* of, bool scalar, std::size_t nodes)
        : system(of),
          is_scalar(scalar),
          rhs(kDim * nodes),
          node_stride(scalar ? 1 : kDim),
          axis_stride(scalar ? nodes : 1) {
      system->Clear();
    }

    // The residual r, of information W, changes by `by` times the move of b less that of a.
    // `coupled`: what W adds to W r from components that no translation changes.
    void Add(int a, int b, std::optional<std::size_t> link, const Matrix& by, const Matrix& w,
             const Vector& residual, const Vector& coupled = Vector::Zero()) {
      const Vector pull = by.transpose() * (w * residual + coupled);
      const Matrix square = is_scalar ? w : Matrix(by.transpose() * w * by);
      if (b != kHeld) Move(b, square, -pull);
      if (a != kHeld) Move(a, square, pull);
      if (a == kHeld || b == kHeld) return;
      if (is_scalar)
        system->AddToLink(*link, Scalar(-square(0, 0)));
      else
        system->AddToLink(*link, Matrix(-square));
    }

    void Move(int node, const Matrix& square, const Vector& push) {
      if (is_scalar)
        system->AddToNode(node, Scalar(square(0, 0)));
      else
        system->AddToNode(node, square);
      for (std::size_t i = 0; i < kDim; ++i) At(static_cast<std::size_t>(node), i) += push[i];
    }

    double& At(std::size_t node, std::size_t axis) {
      return rhs[node * node_stride + axis * axis_stride];
    }

    bool Solve() { return system->Solve(&rhs, is_scalar ? kDim : 1); }
  };

  void AddBetween(const Edge& edge, Translations* to) const {
    const int a = index_[edge.a], b = index_[edge.b];
    if (a == kHeld && b == kHeld) return;
    const FactorView factor = graph_.FactorAt(edge.factor);
    const Pose& measured = edge.measured;
    const Vector b_in_a = rotations_[edge.a].transpose() * (PointAt(edge.b) - PointAt(edge.a));
    const Matrix by = (rotations_[edge.a] * measured.rotation).transpose();
    const Vector residual = measured.rotation.transpose() * (b_in_a - measured.Translation());
    const Information w = InformationOfFactor(factor);
    const auto coupling = w.template topRightCorner<kDim, kTurn>();
    Vector coupled = Vector::Zero();
    if (!coupling.isZero(0)) {
      double reached[7];
      Between(kPlanar, PoseAt(edge.a).stored, PoseAt(edge.b).stored, reached);
      coupled = coupling * TurnBetween(factor, measured.stored, reached);
    }
    to->Add(a, b, edge.link, by, w.template topLeftCorner<kDim, kDim>(), residual, coupled);
  }

  void AddPrior(const Prior& prior, Translations* to) const {
    if (index_[prior.pose] == kHeld) return;
    const FactorView factor = graph_.FactorAt(prior.factor);
    const Pose measured = PoseFrom(factor.measurement.data()), pose = PoseAt(prior.pose);
    double reached[7];
    if (RoleOf(prior.factor) == PoseRole::kPriorWithOffset)
      Compose(kPlanar, pose.stored, PoseFrom(factor.measurement.data() + 7).stored, reached);
    else
      std::copy_n(pose.stored, PoseSize(kPlanar), reached);
    const Matrix by = measured.rotation.transpose();
    const Information w = InformationOfFactor(factor);
    to->Add(
        kHeld, index_[prior.pose], {}, by, w.template topLeftCorner<kDim, kDim>(),
        by * (Eigen::Map<const Vector>(reached) - measured.Translation()),
        w.template topRightCorner<kDim, kTurn>() * TurnBetween(factor, measured.stored, reached));
  }

  // A point where the body or a sensor on it sees it, and how well: false where it says too little.
  struct Sighting {
    VariableId pose, landmark;
    Matrix w;
    Vector measured;
    Pose body_from_sensor;
  };
  bool Read(FactorId id, Sighting* sight) const {
    const FactorView factor = graph_.FactorAt(id);
    const double* measured = factor.measurement.data();
    constexpr double kNone[7] = {0, 0, 0, 0, 0, 0, 1};
    sight->body_from_sensor = PoseFrom(kNone);
    sight->pose = factor.variables[0];
    sight->landmark = factor.variables[1];
    sight->w = InformationOf<kDim>(factor.noise);
    sight->measured = Eigen::Map<const Vector>(measured);
    if (RoleOf(id) == PoseRole::kLandmarkWithOffset) {
      sight->body_from_sensor = PoseFrom(measured + kDim);
    } else if (RoleOf(id) == PoseRole::kBearingRange) {
      const double c = std::cos(measured[0]), s = std::sin(measured[0]), range = measured[1];
      if (!(range > 0)) return false;
      Matrix polar = Matrix::Zero();  // d (bearing, range) / d (x, y)
      polar.template topLeftCorner<2, 2>() << -s / range, c / range, c, s;
      sight->w = Matrix(polar.transpose() * sight->w * polar);
      sight->measured.template head<2>() << range * c, range * s;
    }
    return std::isfinite(TraceOfInverse(sight->w));
  }

  // Landmarks join in from where they were seen by one group of poses that agree on a frame.
  std::vector<Sighting> JoinLandmarks() {
    std::vector<Sighting> sights;
    Sighting sight;
    for (const FactorId id : others_) {
      const PoseRole role = RoleOf(id);
      if (role == PoseRole::kPosition || role == PoseRole::kPriorPoint) continue;
      if (!Read(id, &sight)) continue;
      std::uint32_t& group = group_[sight.landmark];
      if (group == kNoGroup) {
        group = graph_.IsFixed(sight.landmark) ? kWorld : group_[sight.pose];
        if (!graph_.IsFixed(sight.landmark)) {
          index_[sight.landmark] = static_cast<int>(poses_.size() + landmarks_.size());
          landmarks_.push_back(sight.landmark);
        }
      }
      if (group == group_[sight.pose]) sights.push_back(sight);
    }
    return sights;
  }

  void AddSighting(const Sighting& sight, std::optional<std::size_t> link, Translations* to) const {
    const Matrix& rotation = rotations_[sight.pose];
    const Pose& sensor = sight.body_from_sensor;
    const Vector in_body = rotation.transpose() * (PointAt(sight.landmark) - PointAt(sight.pose));
    to->Add(index_[sight.pose], index_[sight.landmark], link,
            (rotation * sensor.rotation).transpose(), sight.w,
            sensor.rotation.transpose() * (in_body - sensor.Translation()) - sight.measured);
  }

  // A place in the world, of a pose or a landmark.
  void AddPlace(FactorId id, Translations* to) const {
    const FactorView factor = graph_.FactorAt(id);
    const VariableId variable = factor.variables[0];
    if (group_[variable] != kWorld || index_[variable] == kHeld) return;
    const double* measured = factor.measurement.data();
    Vector residual = PointAt(variable) - Eigen::Map<const Vector>(measured);
    if (RoleOf(id) == PoseRole::kPosition && !kPlanar)
      residual += rotations_[variable] * Eigen::Map<const Vector>(measured + kDim);
    to->Add(kHeld, index_[variable], {}, Matrix::Identity(), InformationOf<kDim>(factor.noise),
            residual);
  }

  bool SolveTranslations(BlockSystem* rotations) {
    const std::vector<Sighting> sights = JoinLandmarks();
    std::vector<std::pair<int, int>> links = links_;
    for (const Sighting& sight : sights)
      if (index_[sight.pose] != kHeld && index_[sight.landmark] != kHeld)
        links.emplace_back(index_[sight.pose], index_[sight.landmark]);
    const std::size_t nodes = poses_.size() + landmarks_.size();
    const bool is_scalar = isotropic_ && priors_.empty() && others_.empty();
    std::optional<BlockSystem> own;
    if (is_scalar)
      own.emplace(1, static_cast<int>(nodes), links, rotations);
    else if (!landmarks_.empty())
      own.emplace(kDim, static_cast<int>(nodes), links);
    Translations sum(own ? &*own : rotations, is_scalar, nodes);

    for (const Edge& edge : edges_) AddBetween(edge, &sum);
    for (const Prior& prior : priors_) AddPrior(prior, &sum);
    std::size_t link = links_.size();
    for (const Sighting& sight : sights) {
      AddSighting(sight, link, &sum);
      link += index_[sight.pose] != kHeld && index_[sight.landmark] != kHeld;
    }
    for (const FactorId id : others_)
      if (RoleOf(id) == PoseRole::kPosition || RoleOf(id) == PoseRole::kPriorPoint)
        AddPlace(id, &sum);
    if (!sum.Solve()) return false;
    const auto move = [&](std::size_t node) {
      Vector by;
      for (std::size_t i = 0; i < kDim; ++i) by[i] = sum.At(node, i);
      return by;
    };
    for (std::size_t i = 0; i < poses_.size(); ++i)
      Eigen::Map<Vector>(values_->Mutable(poses_[i])) += move(i);
    for (std::size_t i = 0; i < landmarks_.size(); ++i)
      placed_landmarks_.emplace_back(landmarks_[i],
                                     PointAt(landmarks_[i]) + move(poses_.size() + i));
    return true;
  }

  const Graph& graph_;
  Values* values_;
  std::vector<VariableId> order_;
  std::vector<bool> pose_type_;
  std::vector<PoseRole> roles_;
  std::vector<Edge> edges_;
  std::vector<Prior> priors_;
  std::vector<FactorId> others_;
  std::vector<Matrix> rotations_;              // by variable
  std::vector<int> index_;                     // by variable: its node; kHeld
  std::vector<std::uint32_t> group_;           // by variable: who agree on a frame
  std::vector<VariableId> poses_, landmarks_;  // by node, one after the other
  std::vector<std::pair<int, int>> links_;     // of free poses
  std::vector<std::pair<VariableId, Vector>> placed_landmarks_;
  bool isotropic_ = true;              // of the between factors, in translation
  std::size_t solved_ = 0, kept_ = 0;  // pieces
};

}  // namespace

ChordalReport PlaceByChordal(const Graph& graph, Values* values) {
  ChordalReport report;
  Relaxation<2> plane(graph, values);
  Relaxation<3> space(graph, values);
  plane.Run(&report);
  space.Run(&report);
  report.landmarks = PlaceLandmarks(graph, values);
  plane.WriteLandmarks(values);
  space.WriteLandmarks(values);
  return report;
}

}  // namespace graticule
