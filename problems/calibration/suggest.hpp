#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "graticule/problems/calibration/max_ere.hpp"
#include "graticule/problems/calibration/placement.hpp"
#include "graticule/problems/calibration/posterior.hpp"

namespace graticule {

struct SuggestOptions {
  double sigma_px = 0.1;
  EreOptions ere;
  Detectability detectability;
  std::size_t fewest_tags = 12;  ///< that must be seen; all, where a target has fewer
  double loose = PosteriorOptions().loose;
  /// A person cannot hold a target at any angle: from facing the camera [rad].
  double steepest_rad = 0.9;
  int refinements = 300;  ///< poses tried around the best candidate; 0: none
};

/// A pose of the target that a person is asked to match.
struct Suggestion {
  Se3Array camera_from_target = {};
  std::vector<DetectedCorner> corners;  ///< where its visible corners would appear: what is drawn
  /// Max ERE that is expected with it; 0 while no accuracy is looked for yet.
  double max_ere_px = 0;
};

/// About 60 ways for a target to appear: two sizes at three by three places, each facing the camera
/// and tilted two ways, the middle ones four ways and turned.
std::vector<Placement> CandidatePlacements();

/// Scores poses by the Max ERE that is expected once they were seen: what a frame there would add
/// to the reduced information of the camera's parameters is known in closed form.  The gauge is
/// the options' (the frame's rotation taken out, by default).  The board is taken as known.
class PoseScorer {
 public:
  /// `information` and `scales` of the camera's parameters, as Posterior has them.
  PoseScorer(const Camera& camera, const TargetLayout& target, const Eigen::MatrixXd& information,
             const Eigen::VectorXd& scales, const SuggestOptions& options);

  /// Expected Max ERE after a frame there; infinite if too little of the target would be seen.
  double Score(const Se3Array& camera_from_target) const;

 private:
  const Camera& camera_;
  const TargetLayout& target_;
  Eigen::MatrixXd information_;
  Eigen::VectorXd scales_;
  SuggestOptions options_;
  EreGrid grid_;
};

/// Information of one camera's parameters, everything else marginalised: what PoseScorer begins
/// with.
Eigen::MatrixXd InformationOfCamera(const Posterior& posterior, std::size_t camera);

/// Candidates that can be seen, with their scores; best first.
std::vector<Suggestion> ScoreCandidates(const Camera& camera, const TargetLayout& target,
                                        const Eigen::MatrixXd& information,
                                        const Eigen::VectorXd& scales,
                                        const SuggestOptions& options);

/// The best candidate, moved to where nothing around is better (compass search over the six
/// numbers of its pose).  Deterministic.  None where no candidate can be seen.
std::optional<Suggestion> SuggestPose(const Camera& camera, const TargetLayout& target,
                                      const Eigen::MatrixXd& information,
                                      const Eigen::VectorXd& scales, const SuggestOptions& options);

/// Before anything is known: the first frame in the middle, filling most of the image, tilted
/// sideways; the second tilted upward.  A tilt shows the focal length, which no flat view does.
/// With the camera as it is believed to be; the first, one of a common lens (GuessedCamera).
std::optional<Suggestion> SuggestFirstPose(const Camera& camera, const TargetLayout& target,
                                           std::size_t frame, const SuggestOptions& options);

/// A camera to draw the first suggestion with: angular4 without terms, focal length of 0.75 widths.
CameraIntrinsics GuessedCamera(const ImageSize& size);

}  // namespace graticule
