#include "graticule/problems/pose_graph/simulate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "graticule/problems/pose_graph/neighbours.hpp"
#include "graticule/problems/pose_graph/pair_draw.hpp"
#include "graticule/problems/pose_graph/transform.hpp"
#include "graticule/problems/random.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

using Pose = std::array<double, 7>;  // the first three of it in the plane

void Check(const CityOptions& o) {
  const auto demand = [](bool fine, const char* what) {
    if (!fine) throw Error(std::string("simulated city: expected ") + what, ErrorKind::kUsage);
  };
  demand(o.dimension == 2 || o.dimension == 3, "dimension 2 or 3");
  demand(o.robots >= 1 && o.poses_per_robot >= 1, "at least one robot and one pose");
  demand(static_cast<double>(o.robots) * o.poses_per_robot < 1e9, "less than 1e9 poses");
  demand(o.blocks >= 0 && o.blocks <= 1000000, "blocks of 0 to 1000000");
  demand(o.step_m > 0 && o.block_m >= o.step_m, "a step above 0 m and a block of a step or more");
  demand(o.odometry_sigma_m > 0 && o.odometry_sigma_rad > 0 && o.closure_sigma_m > 0 &&
             o.closure_sigma_rad > 0 && o.landmark_sigma_m > 0,
         "standard deviations above 0");
  demand(o.closure_range_m > 0 && o.landmark_range_m > 0, "ranges above 0 m");
  demand(o.loops_per_pose >= 0 && o.inter_robot_per_pose >= 0 && o.loop_min_gap >= 1,
         "closures a pose of 0 or more, and a gap of 1 or more");
  demand(o.outlier_fraction >= 0 && o.outlier_fraction <= 1, "an outlier fraction of 0 to 1");
  demand(o.landmarks >= 0 && o.start_sigma_m >= 0 && o.start_sigma_rad >= 0,
         "landmarks and start errors of 0 or more");
}

// One stream a purpose: the same seed drives the same route whatever the noise.
enum Stream : std::uint64_t { kRoute, kOdometry, kStart, kClosures, kLandmarks, kSightings };

class City {
 public:
  City(const Registry& types, const CityOptions& options)
      : options_(options), planar_(options.dimension == 2), graph_(types) {
    Check(options);
    steps_per_block_ = std::max(1, static_cast<int>(std::lround(options.block_m / options.step_m)));
    step_m_ = options.block_m / steps_per_block_;
    blocks_ = options.blocks;
    if (blocks_ == 0) {  // 2 B^2 blocks of street, each driven twice
      const double driven_m = step_m_ * options.robots * options.poses_per_robot;
      blocks_ = std::max(2, static_cast<int>(std::sqrt(driven_m / (4 * options.block_m))));
    }
  }

  Simulated Run() {
    Drive();
    ScatterLandmarks();
    const auto count = truth_.size();
    graph_.Reserve(
        count + landmarks_.size(),
        static_cast<std::size_t>(static_cast<double>(count) *
                                 (1 + options_.loops_per_pose + options_.inter_robot_per_pose)));
    AddPosesAndOdometry();
    AddClosures();
    AddSightings();
    Values truth = graph_.InitialValues();
    for (std::size_t i = 0; i < count; ++i)
      std::copy_n(truth_[i].data(), PoseSize(planar_), truth.Mutable(static_cast<VariableId>(i)));
    for (std::size_t i = 0; i < landmarks_.size(); ++i)
      std::copy_n(landmarks_[i].data(), options_.dimension,
                  truth.Mutable(static_cast<VariableId>(count + i)));
    return {std::move(graph_), std::move(truth), std::move(outliers_)};
  }

 private:
  using Point = std::array<double, 3>;

  std::size_t Robot(std::size_t pose) const {
    return pose / static_cast<std::size_t>(options_.poses_per_robot);
  }

  // ---------------------------------------------------------------------------------- the truth

  // Height of the street and its slope along x and y.
  Point Hill(double x_m, double y_m) const {
    const double k = 2 * M_PI / 100, a = options_.hill_height_m / 2;
    return {a * (std::sin(k * x_m) + std::cos(0.7 * k * y_m)), a * k * std::cos(k * x_m),
            -0.7 * a * k * std::sin(0.7 * k * y_m)};
  }

  Pose OnTheGround(double x_m, double y_m, int heading) const {
    constexpr double kYaw[4] = {0, M_PI / 2, M_PI, -M_PI / 2};
    constexpr int kX[4] = {1, 0, -1, 0}, kY[4] = {0, 1, 0, -1};
    if (planar_) return {x_m, y_m, kYaw[heading]};
    // Yaw, then pitch along the slope, then roll across it: the wheels stay on the ground.
    const auto [z, slope_x, slope_y] = Hill(x_m, y_m);
    const double along = slope_x * kX[heading] + slope_y * kY[heading];
    const double across = slope_y * kX[heading] - slope_x * kY[heading];
    const double yaw = kYaw[heading] / 2, pitch = -std::atan(along) / 2;
    const double roll = std::atan(across / std::sqrt(1 + along * along)) / 2;
    const double turn[4] = {0, 0, std::sin(yaw), std::cos(yaw)};
    const double nod[4] = {0, std::sin(pitch), 0, std::cos(pitch)};
    const double lean[4] = {std::sin(roll), 0, 0, std::cos(roll)};
    double turn_nod[4];
    Pose pose = {x_m, y_m, z};
    QuaternionProduct(turn, nod, turn_nod);
    QuaternionProduct(turn_nod, lean, pose.data() + 3);
    return pose;
  }

  // Straight on, or where a corner and the town's edge allow, left or right.
  int NextHeading(int x, int y, int heading, RandomNumbers* random) const {
    if (x % steps_per_block_ || y % steps_per_block_) return heading;
    const int last = blocks_ * steps_per_block_;
    const bool open[4] = {x<last, y<last, x> 0, y> 0};
    int choices[4], count = 0;
    for (const int turn : {0, 0, 1, 3})  // straight on is twice as likely as either turn
      if (open[(heading + turn) % 4]) choices[count++] = (heading + turn) % 4;
    return choices[random->Below(static_cast<std::uint64_t>(count))];
  }

  void Drive() {
    RandomNumbers random(options_.seed, kRoute);
    truth_.reserve(static_cast<std::size_t>(options_.robots) *
                   static_cast<std::size_t>(options_.poses_per_robot));
    const auto corners = static_cast<std::uint64_t>(blocks_ + 1);
    constexpr int kX[4] = {1, 0, -1, 0}, kY[4] = {0, 1, 0, -1};
    for (int robot = 0; robot < options_.robots; ++robot) {
      int x = steps_per_block_ * static_cast<int>(random.Below(corners));
      int y = steps_per_block_ * static_cast<int>(random.Below(corners));
      int heading = NextHeading(x, y, static_cast<int>(random.Below(4)), &random);
      for (int i = 0; i < options_.poses_per_robot; ++i) {
        truth_.push_back(OnTheGround(x * step_m_, y * step_m_, heading));
        x += kX[heading];
        y += kY[heading];
        heading = NextHeading(x, y, heading, &random);
      }
    }
  }

  void ScatterLandmarks() {
    RandomNumbers random(options_.seed, kLandmarks);
    for (int i = 0; i < options_.landmarks; ++i) {
      // In sight of one pose at least.
      const std::size_t seen_from = random.Below(truth_.size());
      const double reach = 0.7 * options_.landmark_range_m;
      const double in_body[3] = {random.Uniform(-reach, reach), random.Uniform(-reach, reach),
                                 random.Uniform(0, 0.1 * reach)};
      Point point{};
      TransformPoint(planar_, truth_[seen_from].data(), in_body, point.data());
      landmarks_.push_back(point);
      landmark_seen_from_.push_back(static_cast<std::uint32_t>(seen_from));
    }
  }

  // ----------------------------------------------------------------------------- what is measured

  // Noise as a pose: [x y yaw], or [x y z] and Exp(rotation vector).
  Pose NoisePose(double sigma_m, double sigma_rad, RandomNumbers* random) const {
    Pose noise{};
    for (int i = 0; i < options_.dimension; ++i)
      noise[static_cast<std::size_t>(i)] = sigma_m * random->Normal();
    if (planar_) {
      noise[2] = sigma_rad * random->Normal();
    } else {
      double rotation[3];
      for (double& r : rotation) r = sigma_rad * random->Normal();
      QuaternionExp(rotation, noise.data() + 3);
    }
    return noise;
  }

  Pose Measure(const Pose& a, const Pose& b, double sigma_m, double sigma_rad,
               RandomNumbers* random) const {
    const Pose noise = NoisePose(sigma_m, sigma_rad, random);
    Pose exact{}, inverse_noise{}, measured{};
    Between(planar_, a.data(), b.data(), exact.data());
    Invert(planar_, noise.data(), inverse_noise.data());
    Compose(planar_, exact.data(), inverse_noise.data(), measured.data());
    return measured;
  }

  std::vector<double> Sigmas(double sigma_m, double sigma_rad) const {
    if (planar_) return {sigma_m, sigma_m, sigma_rad};
    return {sigma_m, sigma_m, sigma_m, sigma_rad, sigma_rad, sigma_rad};
  }

  FactorId AddBetween(std::size_t a, std::size_t b, const Pose& measured,
                      const std::vector<double>& sigmas, const char* source) {
    const VariableId ends[2] = {static_cast<VariableId>(a), static_cast<VariableId>(b)};
    return graph_.Add(between_, {ends, 2},
                      {measured.data(), static_cast<std::size_t>(PoseSize(planar_))},
                      {NoiseKind::kSigma, sigmas}, Loss{}, source);
  }

  void AddPosesAndOdometry() {
    pose_ = graph_.VariableTypeId(planar_ ? "se2/1" : "se3/1");
    between_ = graph_.FactorTypeId(planar_ ? "between_se2/1" : "between_se3/1");
    const auto size = static_cast<std::size_t>(PoseSize(planar_));
    const auto per_robot = static_cast<std::size_t>(options_.poses_per_robot);
    RandomNumbers random(options_.seed, kOdometry), start(options_.seed, kStart);
    std::vector<Pose> measured(truth_.size());
    believed_ = truth_;
    for (std::size_t i = 0; i < truth_.size(); ++i) {
      if (i % per_robot != 0) {
        measured[i] = Measure(truth_[i - 1], truth_[i], options_.odometry_sigma_m,
                              options_.odometry_sigma_rad, &random);
        Compose(planar_, believed_[i - 1].data(), measured[i].data(), believed_[i].data());
      } else if (i != 0) {
        const Pose off = NoisePose(options_.start_sigma_m, options_.start_sigma_rad, &start);
        Compose(planar_, truth_[i].data(), off.data(), believed_[i].data());
      }
      graph_.Add(Key("robot" + std::to_string(Robot(i) + 1), i % per_robot), pose_,
                 {believed_[i].data(), size}, i == 0);
    }
    const auto sigmas = Sigmas(options_.odometry_sigma_m, options_.odometry_sigma_rad);
    for (std::size_t i = 1; i < truth_.size(); ++i)
      if (i % per_robot != 0) AddBetween(i - 1, i, measured[i], sigmas, "odometry");
  }

  // ---------------------------------------------------------------------------------- closures

  void AddClosures() {
    std::vector<Neighbours> by_robot(static_cast<std::size_t>(options_.robots),
                                     Neighbours(options_.closure_range_m));
    Neighbours all(options_.closure_range_m);
    for (std::size_t i = 0; i < truth_.size(); ++i) {
      by_robot[Robot(i)].Add(truth_[i][0], truth_[i][1], static_cast<std::uint32_t>(i));
      all.Add(truth_[i][0], truth_[i][1], static_cast<std::uint32_t>(i));
    }
    for (Neighbours& robot : by_robot) robot.Build();
    all.Build();

    RandomNumbers random(options_.seed, kClosures);
    const auto wanted = [this](double per_pose) {
      return static_cast<std::size_t>(std::llround(per_pose * static_cast<double>(truth_.size())));
    };
    const PairDraw draw{truth_, options_.closure_range_m, &random};
    const auto gap = static_cast<std::size_t>(options_.loop_min_gap);
    const auto loops = draw.Pairs(
        wanted(options_.loops_per_pose),
        [&](std::size_t i) -> const Neighbours& { return by_robot[Robot(i)]; },
        [gap](std::size_t a, std::size_t b) { return std::max(a, b) - std::min(a, b) >= gap; });
    for (const auto& [later, earlier] : loops) AddClosure(earlier, later, "loop", &random);
    if (options_.robots < 2) return;
    const auto meetings = draw.Pairs(
        wanted(options_.inter_robot_per_pose),
        [&](std::size_t) -> const Neighbours& { return all; },
        [this](std::size_t a, std::size_t b) { return Robot(a) != Robot(b); });
    for (const auto& [b, a] : meetings) AddClosure(a, b, "inter_robot", &random);
  }

  void AddClosure(std::size_t a, std::size_t b, const char* source, RandomNumbers* random) {
    const bool wrong = options_.outlier_fraction > 0 && random->Unit() < options_.outlier_fraction;
    Pose seen = truth_[b];
    if (wrong) {
      Pose anywhere{};
      const double reach = options_.closure_range_m;
      for (int i = 0; i < 2; ++i)
        anywhere[static_cast<std::size_t>(i)] = random->Uniform(-reach, reach);
      const double yaw = random->Uniform(-M_PI, M_PI);
      if (planar_) anywhere[2] = yaw;
      if (!planar_) anywhere[5] = std::sin(yaw / 2), anywhere[6] = std::cos(yaw / 2);
      Compose(planar_, truth_[a].data(), anywhere.data(), seen.data());
    }
    const Pose measured =
        Measure(truth_[a], seen, options_.closure_sigma_m, options_.closure_sigma_rad, random);
    const FactorId id = AddBetween(
        a, b, measured, Sigmas(options_.closure_sigma_m, options_.closure_sigma_rad), source);
    if (wrong) outliers_.push_back(id);
  }

  // --------------------------------------------------------------------------------- landmarks

  Point Sight(std::size_t pose, std::size_t landmark, RandomNumbers* random) const {
    Pose body_from_world{};
    Point seen{};
    Invert(planar_, truth_[pose].data(), body_from_world.data());
    TransformPoint(planar_, body_from_world.data(), landmarks_[landmark].data(), seen.data());
    for (double& value : seen) value -= options_.landmark_sigma_m * random->Normal();
    return seen;
  }

  void AddSightings() {
    if (landmarks_.empty()) return;
    Neighbours near(options_.landmark_range_m);
    for (std::size_t i = 0; i < landmarks_.size(); ++i)
      near.Add(landmarks_[i][0], landmarks_[i][1], static_cast<std::uint32_t>(i));
    near.Build();
    struct Sighting {
      std::size_t pose, landmark;
      Point in_body;
    };
    std::vector<Sighting> sightings;
    RandomNumbers random(options_.seed, kSightings);
    for (std::size_t i = 0; i < truth_.size(); ++i)
      near.Around(truth_[i][0], truth_[i][1], [&](std::uint32_t first, std::uint32_t last) {
        for (std::uint32_t entry = first; entry < last; ++entry) {
          const std::uint32_t landmark = near.At(entry);
          const double dx = truth_[i][0] - landmarks_[landmark][0];
          const double dy = truth_[i][1] - landmarks_[landmark][1];
          if (std::hypot(dx, dy) > options_.landmark_range_m) continue;
          const bool sure = landmark_seen_from_[landmark] == i;
          if (sure || random.Unit() < options_.sightings_per_pass)
            sightings.push_back({i, landmark, Sight(i, landmark, &random)});
        }
      });

    const auto size = static_cast<std::size_t>(options_.dimension);
    const auto point = graph_.VariableTypeId(planar_ ? "point2/1" : "point3/1");
    std::vector<Point> believed = landmarks_;
    std::vector<bool> has_been_seen(landmarks_.size());
    for (const Sighting& s : sightings) {
      if (has_been_seen[s.landmark]) continue;
      has_been_seen[s.landmark] = true;
      TransformPoint(planar_, believed_[s.pose].data(), s.in_body.data(),
                     believed[s.landmark].data());
    }
    for (std::size_t i = 0; i < landmarks_.size(); ++i)
      graph_.Add(Key("landmark", i), point, {believed[i].data(), size}, false);
    const auto seen = graph_.FactorTypeId(planar_ ? "landmark_se2/1" : "landmark_se3/1");
    const std::vector<double> sigma = {options_.landmark_sigma_m};
    for (const Sighting& s : sightings) {
      const VariableId ends[2] = {static_cast<VariableId>(s.pose),
                                  static_cast<VariableId>(truth_.size() + s.landmark)};
      graph_.Add(seen, {ends, 2}, {s.in_body.data(), size}, {NoiseKind::kSigma, sigma}, Loss{},
                 "sighting");
    }
  }

  CityOptions options_;
  bool planar_;
  int steps_per_block_ = 1;
  int blocks_ = 1;
  double step_m_ = 1;
  Graph graph_;
  Graph::TypeId pose_ = 0, between_ = 0;
  std::vector<Pose> truth_, believed_;
  std::vector<Point> landmarks_;
  std::vector<std::uint32_t> landmark_seen_from_;
  std::vector<FactorId> outliers_;
};

}  // namespace

Simulated SimulateCity(const Registry& types, const CityOptions& options) {
  return City(types, options).Run();
}

}  // namespace graticule
