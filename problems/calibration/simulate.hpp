#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "graticule/problems/calibration/placement.hpp"
#include "graticule/problems/calibration/state.hpp"
#include "graticule/problems/random.hpp"

namespace graticule {

/// A lens to simulate, after one of Figure 5.8 of the thesis.
struct StudyLens {
  std::string name;         ///< "b, 146 deg"
  double diagonal_deg = 0;  ///< diagonal field of view
  CameraIntrinsics camera;
};

/// Six cameras like those of Figure 5.8: fields of view and resolutions as there, angular4 with
/// terms as such lenses have them.
std::vector<StudyLens> StudyLenses();

/// Who chooses where the target goes, when nobody suggests.
enum class Person {
  /// The target whole in the image, near its middle, at arm's length, hardly tilted: pictures as
  /// people take them.
  kNovice,
  /// As the ROS tutorial says: left, right, top, bottom, filling the view, far (a fifth), tilted to
  /// four sides, in turn; the target whole, as a chessboard needs it.
  kRosRules,
};

/// Where this person puts the target for frame `frame`.  Tries until the whole target is seen, 40
/// times at most, then takes what there is.
Se3Array PoseByPerson(Person person, std::size_t frame, const Camera& camera,
                      const TargetLayout& target, RandomNumbers& random);

/// How well hands hold a target where it should be; standard deviations.
struct HandNoise {
  double across = 0.02;    ///< of the target's place in the image, in image widths
  double distance = 0.04;  ///< of its distance, as a fraction
  double turn_rad = 0.07;  ///< about each axis
};

/// A target held at a pose, nearly: turned about its centre, moved sideways and along the ray.
Se3Array HeldAt(const Se3Array& camera_from_target, const Camera& camera,
                const TargetLayout& target, const HandNoise& noise, RandomNumbers& random);

/// Gaussian noise on both coordinates of every corner.
void AddPixelNoise(double sigma_px, RandomNumbers& random, std::vector<DetectedCorner>* corners);

struct CalibrationSimulation {
  CameraIntrinsics camera;
  TargetLayout target = LayoutOf(AprilCalMosaic());
  std::array<double, 3> warp = {};  ///< xx yy xy [1/m]: a bent board
  double sigma_px = 0.1;
  Detectability detectability;
  std::uint64_t seed = 1;
};

/// Detections with what they were made from.
struct SimulatedDetections {
  Detections detections;
  CalibrationState truth;
};

/// What the camera sees of the target at these poses (camera_from_target).  Frames that see nothing
/// keep an empty view.  Same options, same digits; a frame's noise does not depend on the others.
SimulatedDetections SimulateDetections(const CalibrationSimulation& simulation,
                                       const std::vector<Se3Array>& poses);

/// The same, of poses that a person chooses.
SimulatedDetections SimulateDetections(const CalibrationSimulation& simulation, Person person,
                                       std::size_t frames);

}  // namespace graticule
