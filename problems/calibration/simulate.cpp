#include "graticule/problems/calibration/simulate.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace graticule {
namespace {

// Streams of a seed.
constexpr std::uint64_t kPersonStream = 1, kNoiseStream = 2;

StudyLens Lens(const char* name, double diagonal_deg, int width, int height,
               std::vector<double> terms, double aspect, double right_px, double down_px) {
  const double theta = diagonal_deg / 2 * M_PI / 180, s = theta * theta;
  double radius = 0;  // at focal length 1
  for (std::size_t i = terms.size(); i-- > 0;) radius = s * (terms[i] + radius);
  radius = theta * (1 + radius);
  const double focal = std::hypot(width, height) / 2 / radius;
  std::vector<double> parameters = {focal, focal * aspect, (width - 1) / 2. + right_px,
                                    (height - 1) / 2. + down_px};
  parameters.insert(parameters.end(), terms.begin(), terms.end());
  return {name, diagonal_deg, {"cam0", "angular4", width, height, parameters}};
}

Placement NovicePlacement(RandomNumbers& random) {
  Placement p;
  p.across = 0.5 + 0.08 * random.Normal();
  p.down = 0.5 + 0.08 * random.Normal();
  p.size = random.Uniform(0.3, 0.55);
  p.tilt_sideways = 0.15 * random.Normal();
  p.tilt_up = 0.15 * random.Normal();
  p.roll = 0.08 * random.Normal();
  return p;
}

Placement RosPlacement(std::size_t frame, RandomNumbers& random) {
  constexpr double kTilt = 0.6, kSide = 0.28;
  struct Rule {
    double across, down, size, sideways, up;
  };
  constexpr Rule kRules[] = {
      {0.5, 0.5, 0.45, 0, 0},        {0.5 - kSide, 0.5, 0.4, 0, 0}, {0.5 + kSide, 0.5, 0.4, 0, 0},
      {0.5, 0.5 - kSide, 0.4, 0, 0}, {0.5, 0.5 + kSide, 0.4, 0, 0}, {0.5, 0.5, 0.85, 0, 0},
      {0.5, 0.5, 0.2, 0, 0},         {0.5, 0.5, 0.45, kTilt, 0},    {0.5, 0.5, 0.45, -kTilt, 0},
      {0.5, 0.5, 0.45, 0, kTilt},    {0.5, 0.5, 0.45, 0, -kTilt}};
  const Rule& rule = kRules[frame % (sizeof(kRules) / sizeof(Rule))];
  Placement p;
  p.across = rule.across + 0.05 * random.Normal();
  p.down = rule.down + 0.05 * random.Normal();
  p.size = rule.size * std::exp(0.12 * random.Normal());
  p.tilt_sideways = rule.sideways + 0.12 * random.Normal();
  p.tilt_up = rule.up + 0.12 * random.Normal();
  p.roll = 0.08 * random.Normal();
  return p;
}

}  // namespace

std::vector<StudyLens> StudyLenses() {
  return {
      Lens("a: Fujinon YV2.2x1.4A-2", 143, 648, 482, {-.021, .0085, -.0082, .0017}, 1.001, 7.3,
           -4.1),
      Lens("b: Tamron 13FM22IR", 146, 648, 482, {-.034, .012, -.0101, .0021}, .999, -5.2, 6.4),
      Lens("c: Tamron 13FM28IR", 114, 648, 482, {.041, .011, -.012, .0062}, 1.0005, 4, 3.2),
      Lens("d: Boowon BW38B", 83, 752, 480, {.16, .05, .02, .01}, 1, -6.5, -2.7),
      Lens("e: Boowon BW3M30B", 121, 648, 482, {.025, -.013, .007, -.0012}, 1.002, 3.1, -8.3),
      Lens("f: Boowon BW3M30B", 121, 1296, 964, {.027, -.014, .0073, -.0013}, .9995, -12.4, 9.7)};
}

Se3Array PoseByPerson(Person person, std::size_t frame, const Camera& camera,
                      const TargetLayout& target, RandomNumbers& random) {
  constexpr int kTries = 40;
  Se3Array best = kIdentityPose;
  std::size_t most = 0;
  for (int i = 0; i < kTries; ++i) {
    const Placement placement =
        person == Person::kNovice ? NovicePlacement(random) : RosPlacement(frame, random);
    const auto pose = PlaceTarget(camera, target, placement);
    if (!pose) continue;
    // A person sees whether the target is in the picture, not how large a tag has to be.
    const std::size_t seen = VisibleCorners(camera, target, *pose, {}, {0, 2}).size();
    if (seen > most) {
      most = seen;
      best = *pose;
    }
    if (seen == target.corners.size()) break;
  }
  return best;
}

Se3Array HeldAt(const Se3Array& camera_from_target, const Camera& camera,
                const TargetLayout& target, const HandNoise& noise, RandomNumbers& random) {
  Eigen::Isometry3d pose = IsometryOf(camera_from_target);
  const Eigen::Vector3d centre = target.Centre();
  Eigen::Vector3d place = pose * centre;
  Eigen::Vector3d turn, shift;
  for (int i = 0; i < 3; ++i) turn[i] = noise.turn_rad * random.Normal();
  for (int i = 0; i < 3; ++i) shift[i] = random.Normal();
  const double angle = turn.norm();
  if (angle > 0)
    pose.linear() = pose.linear() * Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  // Sideways as the image shows it: the whole width is about the angle between its left and right.
  const double image_rad =
      camera.Width() / std::max(1., std::sqrt(camera.Intrinsics().parameters[0] *
                                              camera.Intrinsics().parameters[1]));
  const double sideways = noise.across * image_rad * place.norm();
  const Eigen::Vector3d ray = place.normalized(), right = ray.unitOrthogonal();
  place += sideways * (shift[0] * right + shift[1] * ray.cross(right));
  place *= std::exp(noise.distance * shift[2]);
  pose.translation() = place - pose.linear() * centre;
  return PoseOf(pose);
}

void AddPixelNoise(double sigma_px, RandomNumbers& random, std::vector<DetectedCorner>* corners) {
  for (DetectedCorner& corner : *corners)
    for (double& coordinate : corner.pixel) coordinate += sigma_px * random.Normal();
}

SimulatedDetections SimulateDetections(const CalibrationSimulation& simulation,
                                       const std::vector<Se3Array>& poses) {
  const Camera camera(simulation.camera);
  SimulatedDetections result;
  result.detections.cameras = {{simulation.camera.name, camera.Width(), camera.Height()}};
  result.detections.exposures = poses.size();
  result.truth.cameras = {simulation.camera};
  result.truth.camera_from_rig = {kIdentityPose};
  result.truth.warp = simulation.warp;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    TargetView view{"frame " + std::to_string(i), 0, i,
                    VisibleCorners(camera, simulation.target, poses[i], simulation.warp,
                                   simulation.detectability)};
    RandomNumbers random(simulation.seed + 0x9e3779b97f4a7c15u * i, kNoiseStream);
    AddPixelNoise(simulation.sigma_px, random, &view.corners);
    result.detections.views.push_back(std::move(view));
    result.truth.rig_from_target.push_back(poses[i]);
  }
  return result;
}

SimulatedDetections SimulateDetections(const CalibrationSimulation& simulation, Person person,
                                       std::size_t frames) {
  const Camera camera(simulation.camera);
  RandomNumbers random(simulation.seed, kPersonStream);
  std::vector<Se3Array> poses;
  for (std::size_t i = 0; i < frames; ++i)
    poses.push_back(PoseByPerson(person, i, camera, simulation.target, random));
  return SimulateDetections(simulation, poses);
}

}  // namespace graticule
