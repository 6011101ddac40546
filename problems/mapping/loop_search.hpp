#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "graticule/problems/mapping/relative_uncertainty.hpp"
#include "graticule/problems/mapping/scan_match.hpp"
#include "graticule/problems/mapping/scan_track.hpp"

namespace graticule {

/// Two nodes and where the second is, seen from the first.
struct Closure {
  std::uint32_t a = 0, b = 0;
  PlanarPose a_from_b;
  Eigen::Matrix3d information;  ///< of [x y yaw] in b's frame, with the floor that options say
  double score = 0;             ///< mean likelihood
  double matched = 0;           ///< share of points
};

/// How well a node is known from the one before: the match (with its floor), and dead reckoning.
Eigen::Matrix3d MatchInformation(const TrackNode& node, const FrontEndOptions& options);
Eigen::Matrix3d ChainInformation(const TrackNode& node, const FrontEndOptions& options);

/// Looks for places where robots have been before.
class LoopSearch {
 public:
  LoopSearch(const std::vector<TrackNode>& nodes, const FrontEndOptions& options);

  /// Closures that are likely, with nodes at these poses and closures that are believed so far.
  /// What was looked for before is not again, unless poses have moved since.  What would have to be
  /// looked for farther than `window` [m] is left for later, and `has_left` told; with the largest
  /// window of the options, nothing is left.
  std::vector<Closure> Search(const std::vector<PlanarPose>& poses,
                              const std::vector<Closure>& believed, double window, bool* has_left);

  /// Closures between robots of different pieces (SetPieces): any stretch may be any other, turned
  /// by any angle.  Evenly chosen stretches, kMostMeetings searches at most.
  std::vector<Closure> Meetings(const std::vector<PlanarPose>& poses);

  /// Robots of one piece have their poses in one frame; of each robot, the piece's number.  At
  /// first, each robot is a piece, unless options say where all start.
  void SetPieces(std::vector<std::uint32_t> piece_of_robot) { pieces_ = std::move(piece_of_robot); }

  /// With poses known well: of each node and each stretch of nodes near it but for those just
  /// before and after, the match on points.
  std::vector<Closure> Overlaps(const std::vector<PlanarPose>& poses);

  std::size_t Searches() const { return searches_; }

 private:
  struct Candidate {
    std::uint32_t a = 0, b = 0;  // places
    double reach = 0, reach_yaw = 0, cost = 0;
  };
  struct Trial {
    std::uint32_t a = 0, b = 0;  // nodes
    SearchWindow window;
    double least_score = 0;
  };
  struct Worker;

  std::vector<Candidate> Candidates(const std::vector<PlanarPose>& poses,
                                    const std::vector<Closure>& believed, double window,
                                    bool* has_left) const;
  std::vector<UncertainEdge> PlaceEdges(const std::vector<Closure>& believed) const;
  std::vector<Closure> TryAll(const std::vector<Trial>& trials,
                              const std::vector<PlanarPose>& poses);
  bool SearchAllRound(const LikelihoodGrid& grid, const std::vector<SurfacePoint>& points,
                      const Trial& trial, Worker* worker, Match* best) const;
  bool Try(const Trial& trial, const std::vector<PlanarPose>& poses, Worker* worker,
           Closure* closure) const;
  /// Points of nodes whose way is no farther than `reach` from a node, in its frame.
  void Stretch(std::uint32_t node, double reach, const std::vector<PlanarPose>& poses,
               std::vector<SurfacePoint>* points) const;

  const std::vector<TrackNode>& nodes_;
  const FrontEndOptions& options_;
  std::vector<std::uint32_t> places_;    // nodes
  std::vector<std::uint32_t> place_of_;  // of each node
  struct Tried {
    PlanarPose guess;
    double reach;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, Tried> tried_;
  std::size_t threads_ = 1;
  std::vector<std::uint32_t> pieces_;  // of each robot
  std::size_t searches_ = 0;
};

}  // namespace graticule
