#pragma once

#include <functional>
#include <memory>
#include <queue>
#include <vector>

#include "graticule/problems/pose_graph/pose_role.hpp"
#include "graticule/problems/pose_graph/sighting.hpp"
#include "graticule/solver/graph.hpp"
#include "graticule/solver/online.hpp"

namespace graticule {

/// A recorded pose graph as a robot lived it: pose after pose into an Online graph, each with a
/// guess made from the latest values, with the landmarks that are first known with it and the
/// factors that are complete with it.
///
/// Fixed variables come first.  Then the poses: always the smallest key of those that something
/// known leads to, by a between factor or a prior; where nothing does, the smallest of all, at its
/// own value.  So the poses of a family come in order, and another family's from where it was met.
/// A pose is placed from the neighbour that came last, else by its prior.  In each piece that
/// nothing holds (Structure::Piece) its anchor is held, as Solve does.
///
/// A landmark comes with the sighting that says where it is: one that says all of it, or the
/// second bearing of two that cross well.  Those of which that is never known come with the last
/// pose, where PlaceLandmarks would assume them.  Every other variable comes with the first pose,
/// at its own value.  Variables without a factor never come.
///
/// Where poses leave `online` by a lag, factors that come later and touch them are passed over.
class Replay {
 public:
  /// The graph must outlive it and stay as it is; nobody else may add to `online`.
  Replay(const Graph& graph, Online* online);

  bool IsDone() const { return is_done_; }
  /// Adds the next pose and what comes with it; to update is the caller's.  Throws Error as
  /// Online::Add does.
  void Next();
  /// Places what has not come yet, and adds nothing: where a replay is given up.
  void PlaceTheRest();

  /// The graph's values: as of the last update, and the guess for what is in none.
  Values Current();

  /// How uncertain the newest pose's rotation is, seen from where it was placed from: the trace of
  /// its covariance, rad^2.  Infinite where that was not measured, zero where from no other pose.
  double TurnVariance() const { return turn_variance_; }

  std::size_t Poses() const { return poses_; }           ///< that were placed
  std::size_t Roots() const { return roots_; }           ///< that were not placed from others
  std::size_t FreeRoots() const { return free_roots_; }  ///< of these, those that nothing holds
  std::size_t Landmarks() const { return landmarks_; }   ///< that were placed
  std::size_t Assumed() const { return assumed_; }       ///< of these, by an assumption
  /// Factors that were not added: a variable of theirs had left.
  std::size_t PassedOver() const { return passed_over_; }

 private:
  static constexpr FactorId kNoFactor = 0xffffffffu;

  void Sort();
  void Refresh();
  bool IsIn(VariableId id) const { return place_[id] != Layout::kNone; }
  bool IsPlanar(VariableId id) const { return graph_.ValueOf(id).size() == 3; }
  const double* At(VariableId id) const;
  VariableId NextPose();
  void Place(VariableId pose);
  void Enter(VariableId id);
  void Say(FactorId id);
  void EnterPose(VariableId pose);
  void SeeFrom(VariableId pose);
  void EnterFixed();
  void EnterOthers();
  void EnterUnseen();

  const Graph& graph_;
  Online* online_;  // null: values are placed, and nothing is added
  std::shared_ptr<const Values> latest_;
  Values guess_;  // of what is in no update

  // By variable, or by factor.
  std::vector<VariableId> order_;  // by rank
  std::vector<std::size_t> rank_;
  std::vector<char> is_pose_, is_anchor_, awaits_sight_, is_queued_;
  std::vector<PoseRole> roles_;  // by factor type
  std::vector<Sight> sights_;    // by factor type
  std::vector<std::vector<FactorId>> factors_;
  std::vector<FactorId> prior_, first_bearing_;
  std::vector<std::size_t> missing_;  // variables of a factor that are not in
  std::vector<VariableId> place_;     // in the Online graph; Layout::kNone: not in

  // Ranks of poses that something known leads to, the smallest first.
  std::priority_queue<std::size_t, std::vector<std::size_t>, std::greater<>> queue_;
  std::size_t next_root_ = 0;  // no smaller rank is a pose that is not in
  VariableId entered_ = 0;
  std::size_t awaited_poses_ = 0;
  bool is_done_ = false;
  double turn_variance_ = 0;
  std::size_t poses_ = 0, roots_ = 0, free_roots_ = 0, landmarks_ = 0, assumed_ = 0;
  std::size_t passed_over_ = 0;
};

}  // namespace graticule
