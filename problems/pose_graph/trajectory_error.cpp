#include "graticule/problems/pose_graph/trajectory_error.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

using Pairs = std::vector<const TrajectoryPair*>;

struct Pose {
  Eigen::Vector3d position;
  Eigen::Quaterniond rotation;
};

Pose PoseOf(const std::array<double, 7>& pose) {
  return {{pose[0], pose[1], pose[2]}, {pose[6], pose[3], pose[4], pose[5]}};
}

double DegreesOf(const Eigen::Quaterniond& q) {
  return 2 * std::atan2(q.vec().norm(), std::abs(q.w())) * 180 / M_PI;
}

bool IsPlanar(const std::array<double, 7>& pose) {
  return pose[2] == 0 && pose[3] == 0 && pose[4] == 0;
}

class Summing {
 public:
  void Add(double error) {
    ++count_;
    sum_ += error;
    squares_ += error * error;
    max_ = std::max(max_, error);
  }
  ErrorSummary Summary() const {
    if (count_ == 0) return {};
    const auto count = static_cast<double>(count_);
    return {count_, std::sqrt(squares_ / count), sum_ / count, max_};
  }

 private:
  std::size_t count_ = 0;
  double sum_ = 0, squares_ = 0, max_ = 0;
};

struct SummingPoses {
  Summing translation, rotation;
  PoseError Summary() const { return {translation.Summary(), rotation.Summary()}; }
};

// truth ~ scale * rotation * estimate + translation
struct Alignment {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  double scale = 1;
  std::string name = "none";

  Pose operator()(const std::array<double, 7>& estimate) const {
    const Pose pose = PoseOf(estimate);
    return {scale * (rotation * pose.position) + translation, rotation * pose.rotation};
  }
};

Alignment ByFirstPose(const Pairs& pairs) {
  const Pose truth = PoseOf(pairs[0]->truth[0]), estimate = PoseOf(pairs[0]->estimate[0]);
  Alignment alignment;
  alignment.rotation = (truth.rotation * estimate.rotation.conjugate()).normalized();
  alignment.translation = truth.position - alignment.rotation * estimate.position;
  alignment.name = "first pose";
  return alignment;
}

// What Umeyama's solution needs of the points: means, and sums of products about them.
struct Moments {
  double count = 0;
  Eigen::Vector3d truth = Eigen::Vector3d::Zero(), estimate = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();  // truth * estimate'
  double truth_squares = 0, estimate_squares = 0;

  explicit Moments(const Pairs& pairs) {
    const auto each = [&](auto&& visit) {
      for (const TrajectoryPair* pair : pairs)
        for (std::size_t i = 0; i < pair->truth.size(); ++i)
          visit(PoseOf(pair->truth[i]).position, PoseOf(pair->estimate[i]).position);
    };
    each([&](const Eigen::Vector3d& t, const Eigen::Vector3d& e) {
      ++count;
      truth += t;
      estimate += e;
    });
    truth /= count;
    estimate /= count;
    each([&](const Eigen::Vector3d& t, const Eigen::Vector3d& e) {
      products += (t - truth) * (e - estimate).transpose();
      truth_squares += (t - truth).squaredNorm();
      estimate_squares += (e - estimate).squaredNorm();
    });
  }
};

// The rotation of the least squared distances, and the trace of the products after it; false where
// the points leave it open.
bool BestRotation(const Moments& moments, bool planar, Eigen::Quaterniond* rotation,
                  double* trace) {
  // Below this share of what the spread of the points allows, products are rounding errors.
  constexpr double kNothing = 1e-10;
  const double spread = std::sqrt(moments.truth_squares * moments.estimate_squares);
  const Eigen::Matrix3d& products = moments.products;
  if (planar) {
    const double along = products(0, 0) + products(1, 1), across = products(1, 0) - products(0, 1);
    *trace = std::hypot(along, across);
    if (!(*trace > kNothing * spread)) return false;
    const double half = std::atan2(across, along) / 2;
    *rotation = Eigen::Quaterniond(std::cos(half), 0, 0, std::sin(half));
    return true;
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(products, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& singular = svd.singularValues();
  if (!(singular[1] > kNothing * spread)) return false;
  const double handed = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1;
  const Eigen::Vector3d signs(1, 1, handed);
  *rotation = Eigen::Quaterniond(
                  Eigen::Matrix3d(svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose()))
                  .normalized();
  *trace = singular.dot(signs);
  return true;
}

Alignment Align(const Pairs& pairs, TrajectoryAlignment how, bool planar) {
  if (how == TrajectoryAlignment::kNone) return {};
  if (how == TrajectoryAlignment::kFirst) return ByFirstPose(pairs);
  const bool scaled = how == TrajectoryAlignment::kSimilarity;
  const Moments moments(pairs);
  Alignment alignment;
  double trace = 0;
  if (!BestRotation(moments, planar, &alignment.rotation, &trace)) {
    alignment = ByFirstPose(pairs);
    alignment.name += ", for the positions leave the rotation open";
    return alignment;
  }
  if (scaled) alignment.scale = trace / moments.estimate_squares;
  alignment.translation = moments.truth - alignment.scale * (alignment.rotation * moments.estimate);
  alignment.name = std::string(scaled ? "sim" : "se") + (planar ? "2" : "3") +
                   (scaled ? " (Umeyama, with scale)" : " (Umeyama, no scale)");
  return alignment;
}

void AddRelative(const Pose& from, const Pose& to, const Pose& true_from, const Pose& true_to,
                 SummingPoses* sum) {
  const Pose moved{from.rotation.conjugate() * (to.position - from.position),
                   from.rotation.conjugate() * to.rotation};
  const Pose truth{true_from.rotation.conjugate() * (true_to.position - true_from.position),
                   true_from.rotation.conjugate() * true_to.rotation};
  sum->translation.Add((moved.position - truth.position).norm());
  sum->rotation.Add(DegreesOf(truth.rotation.conjugate() * moved.rotation));
}

FamilyAccuracy ErrorsOf(const Pairs& pairs, const TrajectoryErrorOptions& options, bool planar) {
  const Alignment alignment = Align(pairs, options.align, planar);
  SummingPoses ate, step, distance;
  FamilyAccuracy accuracy;
  accuracy.alignment = alignment.name;
  accuracy.scale = alignment.scale;
  for (const TrajectoryPair* pair : pairs) {
    accuracy.poses += pair->poses;
    accuracy.matched += pair->truth.size();
    Pose last, last_truth, mark, true_mark;
    double path_m = 0;
    bool has_mark = false;
    for (std::size_t i = 0; i < pair->truth.size(); ++i) {
      const Pose truth = PoseOf(pair->truth[i]), pose = alignment(pair->estimate[i]);
      ate.translation.Add((pose.position - truth.position).norm());
      ate.rotation.Add(DegreesOf(truth.rotation.conjugate() * pose.rotation));
      if (i > 0) {
        AddRelative(last, pose, last_truth, truth, &step);
        path_m += (truth.position - last_truth.position).norm();
      }
      last = pose;
      last_truth = truth;
      if (path_m < options.rpe_distance_m) continue;
      if (has_mark) AddRelative(mark, pose, true_mark, truth, &distance);
      mark = pose;
      true_mark = truth;
      has_mark = true;
      path_m = 0;
    }
  }
  accuracy.ate = ate.Summary();
  accuracy.rpe_step = step.Summary();
  accuracy.rpe_distance = distance.Summary();
  return accuracy;
}

const std::vector<StampedPose>* TruthOf(const std::string& family, const GroundTruth& truth,
                                        bool only_family) {
  const auto it = truth.find(family);
  if (it != truth.end()) return &it->second;
  return only_family && truth.size() == 1 ? &truth.begin()->second : nullptr;
}

TrajectoryPair PairOf(const std::string& family, const std::vector<StampedPose>& estimate,
                      const std::vector<StampedPose>& truth) {
  std::unordered_map<double, std::size_t> by_stamp;
  for (std::size_t i = 0; i < truth.size(); ++i)
    if (!by_stamp.emplace(truth[i].stamp_s, i).second)
      throw Error("the truth has two poses of " + family + " with the stamp " +
                  Shown(truth[i].stamp_s));
  TrajectoryPair pair{family, estimate.size(), {}, {}};
  for (const StampedPose& pose : estimate) {
    const auto it = by_stamp.find(pose.stamp_s);
    if (it == by_stamp.end()) continue;
    pair.truth.push_back(truth[it->second].world_from_body);
    pair.estimate.push_back(pose.world_from_body);
  }
  if (!pair.truth.empty() || truth.size() != estimate.size()) return pair;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    pair.truth.push_back(truth[i].world_from_body);
    pair.estimate.push_back(estimate[i].world_from_body);
  }
  return pair;
}

}  // namespace

std::vector<TrajectoryPair> PairWithTruth(const Graph& graph, const Values& values,
                                          const GroundTruth& truth) {
  const std::vector<std::string> families = PoseFamilies(graph);
  std::vector<TrajectoryPair> pairs;
  std::size_t matched = 0;
  for (const std::string& family : families) {
    const std::vector<StampedPose>* poses = TruthOf(family, truth, families.size() == 1);
    const std::vector<StampedPose> estimate = Trajectory(graph, values, family);
    pairs.push_back(poses ? PairOf(family, estimate, *poses)
                          : TrajectoryPair{family, estimate.size(), {}, {}});
    matched += pairs.back().truth.size();
  }
  if (matched > 0) return pairs;
  std::string list;
  for (const auto& [family, poses] : truth)
    list += (list.empty() ? "" : ", ") + std::to_string(poses.size()) + " of " + family;
  throw Error("no pose has a truth: no stamp or key of the truth (" +
              (list.empty() ? "no poses" : list) + ") is that of a pose here");
}

Accuracy TrajectoryErrors(const std::vector<TrajectoryPair>& pairs,
                          const TrajectoryErrorOptions& options) {
  Pairs matched;
  std::size_t unmatched = 0;
  bool planar = true;
  for (const TrajectoryPair& pair : pairs) {
    if (pair.truth.empty()) {
      unmatched += pair.poses;
      continue;
    }
    matched.push_back(&pair);
    planar = planar && std::all_of(pair.truth.begin(), pair.truth.end(), IsPlanar) &&
             std::all_of(pair.estimate.begin(), pair.estimate.end(), IsPlanar);
  }
  Accuracy accuracy;
  accuracy.rpe_distance_m = options.rpe_distance_m;
  if (matched.empty()) return accuracy;
  accuracy.together = ErrorsOf(matched, options, planar);
  accuracy.together.poses += unmatched;
  if (matched.size() < 2) return accuracy;
  for (const TrajectoryPair* pair : matched) {
    accuracy.families.push_back(ErrorsOf({pair}, options, planar));
    accuracy.families.back().family = pair->family;
  }
  return accuracy;
}

}  // namespace graticule
