#include "graticule/problems/pose_graph/certify_program.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "graticule/problems/pose_graph/information.hpp"
#include "graticule/problems/pose_graph/nearest_rotation.hpp"
#include "graticule/problems/pose_graph/transform.hpp"
#include "graticule/solver/union_find.hpp"

namespace graticule {
namespace {

template <int kDim>
Frame<kDim> FrameFrom(const double* given) {
  constexpr bool kPlanar = kDim == 2;
  double pose[7];
  CopyPose(kPlanar, given, pose);
  Frame<kDim> frame;
  for (int i = 0; i < kDim; ++i) frame.translation[i] = pose[i];
  if constexpr (kPlanar) {
    const double c = std::cos(pose[2]), s = std::sin(pose[2]);
    frame.rotation << c, -s, s, c;
  } else {
    RowMajor<3, 3> rotation;
    QuaternionToMatrix(pose + 3, rotation.data());
    frame.rotation = rotation;
  }
  return frame;
}

template <int kDim>
Frame<kDim> PlaceFrom(const double* given) {
  Frame<kDim> frame;
  for (int i = 0; i < kDim; ++i) frame.translation[i] = given[i];
  return frame;
}

// Numbers of factors by why they cannot be stated, in words.
class Complaints {
 public:
  void Add(const std::string& what) { ++counts_[what]; }
  void Say(std::vector<std::string>* reasons) const {
    for (const auto& [what, count] : counts_) {
      std::string text = what;
      const std::size_t at = text.find('#');
      text.replace(at, 1, std::to_string(count) + (count == 1 ? " factor" : " factors"));
      reasons->push_back(text);
    }
  }

 private:
  std::map<std::string, std::size_t> counts_;
};

template <int kDim>
class Reader {
 public:
  Reader(const Graph& graph, Program<kDim>* program) : graph_(graph), program_(*program) {
    for (const FactorType& type : graph.UsedFactorTypes()) {
      const bool planar = type.name.find("se2/") != std::string::npos ||
                          type.name.find("point2/") != std::string::npos;
      roles_.push_back(planar == (kDim == 2) ? PoseRoleOf(type.name) : PoseRole::kOther);
    }
    for (const VariableType& type : graph.UsedVariableTypes()) {
      is_pose_.push_back(type.name == (kDim == 2 ? "se2/1" : "se3/1"));
      is_point_.push_back(type.name == (kDim == 2 ? "point2/1" : "point3/1"));
    }
  }

  void Run(std::vector<std::string>* reasons) {
    if (!PlaceNodes(reasons)) return;
    Complaints complaints;
    for (FactorId id = 0; id < graph_.FactorCount(); ++id) AddFactor(id, &complaints);
    complaints.Say(reasons);
  }

 private:
  using Statement = typename Program<kDim>::Statement;
  using Turn = typename Program<kDim>::Turn;
  static constexpr int kTurn = Program<kDim>::kTurn;

  bool PlaceNodes(std::vector<std::string>* reasons) {
    place_.resize(graph_.VariableCount());
    std::size_t strange = 0;
    for (const VariableId id : graph_.KeyOrder()) {
      const auto type = graph_.VariableTypeIndex(id);
      if (!is_pose_[type] && !is_point_[type]) {
        ++strange;
        continue;
      }
      if (graph_.IsFixed(id)) {
        place_[id].node = World(PlaceFrom<kDim>(graph_.ValueOf(id).data()).translation);
        place_[id].offset = is_pose_[type] ? FrameFrom<kDim>(graph_.ValueOf(id).data())
                                           : PlaceFrom<kDim>(graph_.ValueOf(id).data());
        place_[id].offset.translation -= program_.origin;
      } else {
        place_[id].node = program_.NodeCount();
        program_.is_point.push_back(is_point_[type]);
        program_.nodes.emplace_back(id, place_[id].node);
      }
    }
    if (strange)
      reasons->push_back(std::to_string(strange) +
                         (strange == 1 ? " variable is" : " variables are") +
                         " neither poses nor points of one space");
    return strange == 0;
  }

  int World(const Eigen::Matrix<double, kDim, 1>& near) {
    if (program_.world < 0) {
      program_.world = program_.NodeCount();
      program_.is_point.push_back(false);
      program_.origin = near;
    }
    return program_.world;
  }

  // A measurement in the world.
  void SeeFromWorld(const Frame<kDim>& world_from, Statement* statement) {
    statement->a = World(world_from.translation);
    statement->measured = world_from;
    statement->measured.translation -= program_.origin;
  }

  void SeeFrom(VariableId id, Statement* statement) const {
    statement->a = place_[id].node;
    statement->a_offset = place_[id].offset;
  }

  void AddFactor(FactorId id, Complaints* complaints) {
    const FactorView factor = graph_.FactorAt(id);
    const PoseRole role = roles_[graph_.FactorTypeIndex(id)];
    if (role == PoseRole::kOther || role == PoseRole::kBearingRange)
      return complaints->Add("# of type " + factor.type->name + ": no quadratic statement");
    if (factor.loss.kind != LossKind::kNone)
      return complaints->Add("# with loss " + std::string(LossName(factor.loss.kind)));

    Statement statement;
    const double* given = factor.measurement.data();
    VariableId of = factor.variables[0];
    bool turns = false;
    switch (role) {
      case PoseRole::kBetween:
        SeeFrom(factor.variables[0], &statement);
        of = factor.variables[1];
        statement.measured = FrameFrom<kDim>(given);
        turns = true;
        break;
      case PoseRole::kPrior:
      case PoseRole::kPriorWithOffset:
        SeeFromWorld(FrameFrom<kDim>(given), &statement);
        turns = true;
        break;
      case PoseRole::kPosition:
      case PoseRole::kPriorPoint:
        SeeFromWorld(PlaceFrom<kDim>(given), &statement);
        break;
      default:  // landmarks
        SeeFrom(factor.variables[0], &statement);
        of = factor.variables[1];
        statement.measured = PlaceFrom<kDim>(given);
    }
    statement.b = place_[of].node;
    statement.b_offset = place_[of].offset;
    if constexpr (kDim == 3) {
      if (role == PoseRole::kPriorWithOffset)
        statement.b_offset = statement.b_offset * FrameFrom<3>(given + 7);
      else if (role == PoseRole::kPosition)
        statement.b_offset = statement.b_offset * PlaceFrom<3>(given + 3);
      else if (role == PoseRole::kLandmarkWithOffset)
        statement.a_offset = statement.a_offset * FrameFrom<3>(given + 3);
    }
    if (turns) {
      statement.w = InformationOf<kDim + kTurn>(factor.noise);
      statement.turn = IsHalfAngle(factor.type->name) ? Turn::kQuaternion : Turn::kAngle;
      statement.couples = !statement.w.template topRightCorner<kDim, kTurn>().isZero(0);
    } else {
      statement.w.template topLeftCorner<kDim, kDim>() = InformationOf<kDim>(factor.noise);
    }
    const bool is_whole = turns ? std::isfinite(TraceOfInverse(statement.w))
                                : std::isfinite(TraceOfInverse(Eigen::Matrix<double, kDim, kDim>(
                                      statement.w.template topLeftCorner<kDim, kDim>())));
    if (!is_whole) return complaints->Add("# with a component that was not measured");
    if (statement.a != statement.b) {
      program_.statements.push_back(statement);
      return;
    }
    statement.a = statement.b = 0;  // the world, seen from itself
    Poses<kDim> world = Poses<kDim>::Zero(kDim, kDim + 1);
    world.template rightCols<kDim>().setIdentity();
    const auto r = ResidualOf<kDim>(statement, world);
    program_.constant += 0.5 * r.dot(statement.w * r);
  }

  struct Place {
    int node = -1;
    Frame<kDim> offset;
  };
  const Graph& graph_;
  Program<kDim>& program_;
  std::vector<PoseRole> roles_;           // by factor type
  std::vector<bool> is_pose_, is_point_;  // by variable type
  std::vector<Place> place_;              // by variable
};

}  // namespace

bool HasPoses(const Graph& graph, int dimension) {
  const auto& types = graph.UsedVariableTypes();
  return std::any_of(types.begin(), types.end(), [&](const VariableType& type) {
    return type.name == (dimension == 2 ? "se2/1" : "se3/1");
  });
}

template <int kDim>
std::vector<std::pair<int, int>> Program<kDim>::Links() const {
  std::vector<std::pair<int, int>> links;
  links.reserve(statements.size());
  for (const Statement& statement : statements) links.emplace_back(statement.a, statement.b);
  return links;
}

template <int kDim>
std::vector<bool> Program<kDim>::Pins() const {
  UnionFind pieces(is_point.size());
  for (const Statement& statement : statements)
    pieces.Join(static_cast<std::uint32_t>(statement.a), static_cast<std::uint32_t>(statement.b));
  std::vector<bool> pins(is_point.size()), pinned(is_point.size());
  // A point cannot keep its piece from turning.
  for (const bool points : {false, true})
    for (std::uint32_t node = 0; node < pins.size(); ++node) {
      const std::uint32_t piece = pieces.Root(node);
      if (is_point[node] != points || pinned[piece]) continue;
      pins[node] = pinned[piece] = true;
    }
  return pins;
}

template <int kDim>
Poses<kDim> Program<kDim>::Read(const Values& values) const {
  Poses<kDim> poses = Poses<kDim>::Zero(kDim, (kDim + 1) * NodeCount());
  if (world >= 0) poses.template middleCols<kDim>((kDim + 1) * world + 1).setIdentity();
  // Near the origin: far from it, products of translations with small numbers lose digits.
  Vector centre = origin;
  if (world < 0 && !nodes.empty())
    centre = PlaceFrom<kDim>(values[nodes[0].first].data()).translation;
  for (const auto& [id, node] : nodes) {
    const double* value = values[id].data();
    const Frame<kDim> frame =
        is_point[static_cast<std::size_t>(node)] ? PlaceFrom<kDim>(value) : FrameFrom<kDim>(value);
    poses.col((kDim + 1) * node) = frame.translation - centre;
    if (!is_point[static_cast<std::size_t>(node)])
      poses.template middleCols<kDim>((kDim + 1) * node + 1) = frame.rotation;
  }
  return poses;
}

template <int kDim>
void Program<kDim>::Write(const Poses<kDim>& poses, Values* values) const {
  Frame<kDim> back;  // the frame that the poses are given in, to the graph's own
  if (world >= 0) {
    const Matrix turn = poses.template middleCols<kDim>((kDim + 1) * world + 1).transpose();
    back = {turn, origin - turn * poses.col((kDim + 1) * world)};
  } else if (const auto pose =
                 std::find_if(nodes.begin(), nodes.end(),
                              [&](const auto& node) {
                                return !is_point[static_cast<std::size_t>(node.second)];
                              });
             pose != nodes.end()) {
    const Frame<kDim> first = FrameFrom<kDim>((*values)[pose->first].data());
    const int column = (kDim + 1) * pose->second;
    const Matrix turn = first.rotation * poses.template middleCols<kDim>(column + 1).transpose();
    back = {turn, first.translation - turn * poses.col(column)};
  }
  for (const auto& [id, node] : nodes) {
    double* value = values->Mutable(id);
    const Vector place = back.rotation * poses.col((kDim + 1) * node) + back.translation;
    std::copy_n(place.data(), kDim, value);
    if (is_point[static_cast<std::size_t>(node)]) continue;
    const Matrix turn = back.rotation * poses.template middleCols<kDim>((kDim + 1) * node + 1);
    if constexpr (kDim == 2)
      value[2] = WrapAngle(std::atan2(turn(1, 0), turn(0, 0)));
    else
      NearestRotation(turn, value + 3);
  }
}

template <int kDim>
Program<kDim> ReadProgram(const Graph& graph, std::vector<std::string>* reasons) {
  Program<kDim> program;
  Reader<kDim>(graph, &program).Run(reasons);
  return program;
}

template <int kDim>
typename Program<kDim>::Residual ResidualOf(const typename Program<kDim>::Statement& statement,
                                            const Poses<kDim>& poses) {
  using Turn = typename Program<kDim>::Turn;
  const auto frame = [&](int node) {
    Frame<kDim> at;
    at.translation = poses.col((kDim + 1) * node);
    at.rotation = poses.template middleCols<kDim>((kDim + 1) * node + 1);
    return at;
  };
  const Frame<kDim> a = frame(statement.a) * statement.a_offset;
  const Frame<kDim> b = frame(statement.b) * statement.b_offset;
  const auto back = statement.measured.rotation.transpose();
  typename Program<kDim>::Residual residual = Program<kDim>::Residual::Zero();
  residual.template head<kDim>() =
      back *
      (a.rotation.transpose() * (b.translation - a.translation) - statement.measured.translation);
  if (statement.turn == Turn::kNone) return residual;
  const Eigen::Matrix<double, kDim, kDim> error = back * a.rotation.transpose() * b.rotation;
  if constexpr (kDim == 2) {
    residual[2] = std::atan2(error(1, 0) - error(0, 1), error.trace());
  } else {
    const Eigen::Quaterniond q = Eigen::Quaterniond(error).normalized();
    if (statement.turn == Turn::kQuaternion)
      VectorPart::Evaluate(q.coeffs().data(), residual.data() + 3, nullptr);
    else
      RotationVector::Evaluate(q.coeffs().data(), residual.data() + 3, nullptr);
  }
  return residual;
}

template struct Program<2>;
template struct Program<3>;
template Program<2> ReadProgram<2>(const Graph&, std::vector<std::string>*);
template Program<3> ReadProgram<3>(const Graph&, std::vector<std::string>*);
template Program<2>::Residual ResidualOf<2>(const Program<2>::Statement&, const Poses<2>&);
template Program<3>::Residual ResidualOf<3>(const Program<3>::Statement&, const Poses<3>&);

}  // namespace graticule
