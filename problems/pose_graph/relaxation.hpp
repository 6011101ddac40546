#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "graticule/factors/lie.hpp"
#include "graticule/solver/block_system.hpp"
#include "graticule/problems/pose_graph/chordal.hpp"
#include "graticule/problems/pose_graph/information.hpp"
#include "graticule/problems/pose_graph/pose_pieces.hpp"
#include "graticule/problems/pose_graph/pose_role.hpp"
#include "graticule/problems/pose_graph/transform.hpp"

namespace graticule {

/// PlaceByChordal for all poses and landmarks of the plane (2) or of space (3).
template <int kDim>
class Relaxation {
 public:
  Relaxation(const Graph& graph, Values* values);

  /// False where CHOLMOD found no solution; then nothing has changed.
  bool Run(ChordalReport* report);

  /// The landmarks that the translations brought with them, onto `values`.
  void WriteLandmarks(Values* values) const {
    for (const auto& [id, point] : placed_landmarks_)
      std::copy_n(point.data(), kDim, values->Mutable(id));
  }

 private:
  static constexpr int kHeld = PosePieces::kHeld;
  static constexpr std::uint32_t kWorld = PosePieces::kWorld, kNoGroup = PosePieces::kNoGroup;
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

  static Pose PoseFrom(const double* given);
  Pose PoseAt(VariableId id) const { return PoseFrom((*values_)[id].data()); }
  void Write(VariableId id, const Pose& pose) {
    std::copy_n(pose.stored, PoseSize(kPlanar), values_->Mutable(id));
  }
  Vector PointAt(VariableId id) const { return Eigen::Map<const Vector>((*values_)[id].data()); }

  Information InformationOfFactor(const FactorView& factor) const {
    return InformationOf<kDim + kTurn>(factor.noise);
  }

  double Kappa(const FactorView& factor, const Information& information) const;

  // A point where the body or a sensor on it sees it, and how well.
  struct Sighting {
    VariableId pose, landmark;
    Matrix w;
    Vector measured;
    Pose body_from_sensor;
  };

  void Collect();
  void FindPieces();
  bool SolveRotations(BlockSystem* system);

  struct Translations;
  static Turn TurnBetween(const FactorView& factor, const double* measured, const double* reached);
  void AddBetween(const Edge& edge, Translations* to) const;
  void AddPrior(const Prior& prior, Translations* to) const;
  bool Read(FactorId id, Sighting* sight) const;
  std::vector<Sighting> JoinLandmarks();
  void AddSighting(const Sighting& sight, std::optional<std::size_t> link, Translations* to) const;
  void AddPlace(FactorId id, Translations* to) const;
  bool SolveTranslations(BlockSystem* rotations);

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

}  // namespace graticule
