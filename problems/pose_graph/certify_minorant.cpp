#include "graticule/problems/pose_graph/certify_minorant.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "graticule/factors/lie.hpp"

namespace graticule {
namespace {

template <int kDim>
using Statement = typename Program<kDim>::Statement;
template <int kDim>
using Matrix = Eigen::Matrix<double, kDim, kDim>;
template <int kDim>
using Vector = Eigen::Matrix<double, kDim, 1>;

// What stands in for a statement's cost 0.5 r' W r, of e and the turn's matrix E = R_m' R_a'' R_b':
//   0.5 tau |e|^2 + pull' e - <turn, E> + a constant.
template <int kDim>
struct Part {
  double tau = 0;
  Vector<kDim> pull = Vector<kDim>::Zero();
  Matrix<kDim> turn = Matrix<kDim>::Zero();
  double shortfall = 0;
  bool is_exact = true;
};

// Near a half turn minorants that touch have hardly any curvature left; there they do not.
constexpr double kLargestAngle = 0.9 * M_PI;
constexpr double kSmallestScalar = 0.15;  // cos(0.9 pi / 2)

// 2 x / sin(x): the weight that makes the chord touch the squared angle x^2 from below.
double Steepening(double angle) {
  return angle > 1e-4 ? 2 * angle / std::sin(angle) : 2 + angle * angle / 3;
}

// Smallest eigenvalue, less what rounding may have added to it.
template <class Symmetric>
double Smallest(const Symmetric& matrix) {
  const Eigen::SelfAdjointEigenSolver<Symmetric> solver(matrix, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[0] - 4e-15 * matrix.trace();
}

double SmallestOfPlane(double xx, double xy, double yy) {
  return (xx + yy) / 2 - std::hypot((xx - yy) / 2, xy) - 4e-15 * (xx + yy);
}

bool IsScalar(const Eigen::Ref<const Eigen::MatrixXd>& m) {
  for (int i = 0; i < m.rows(); ++i)
    for (int j = 0; j < m.cols(); ++j)
      if (m(i, j) != (i == j ? m(0, 0) : 0)) return false;
  return true;
}

// tau of W >= diag(tau, tau, kappa).
double TauBeside(const Eigen::Matrix3d& w, double kappa) {
  const double left = w(2, 2) - kappa;
  const double xx = w(0, 0) - w(0, 2) * w(0, 2) / left, yy = w(1, 1) - w(1, 2) * w(1, 2) / left;
  const double xy = w(0, 1) - w(0, 2) * w(1, 2) / left;
  return SmallestOfPlane(xx, xy, yy);
}

// The plane: 0.5 r' W r >= 0.5 r' M r + z' (W - M) r - 0.5 z' (W - M) z for every M <= W and z;
// with M = diag(tau, tau, kappa) and z = r it touches at r.  What it says of the angle is a
// parabola, and a cosine about its vertex touches that from below.
Part<2> PlanarMinorant(const Statement<2>& statement, const Eigen::Vector3d& r) {
  const Eigen::Matrix3d& w = statement.w;
  const Eigen::Matrix2d we = w.topLeftCorner<2, 2>();
  Part<2> part;
  if (statement.turn == Program<2>::Turn::kNone) {
    part.tau = IsScalar(we) ? we(0, 0) : SmallestOfPlane(we(0, 0), we(0, 1), we(1, 1));
    part.pull = we * r.head<2>() - part.tau * r.head<2>();
    return part;
  }
  double kappa = w(2, 2);
  if (!statement.couples) {
    part.tau = IsScalar(we) ? we(0, 0) : SmallestOfPlane(we(0, 0), we(0, 1), we(1, 1));
  } else {
    // The largest tau^2 kappa, by golden section.
    const double ratio = (std::sqrt(5.0) - 1) / 2;
    double low = 0, high = kappa;
    const auto score = [&](double k) {
      const double tau = TauBeside(w, k);
      return tau > 0 ? tau * tau * k : tau;
    };
    double left = high - ratio * (high - low), right = low + ratio * (high - low);
    double at_left = score(left), at_right = score(right);
    for (int step = 0; step < 24; ++step) {
      if (at_left < at_right) {
        low = left, left = right, at_left = at_right;
        at_right = score(right = low + ratio * (high - low));
      } else {
        high = right, right = left, at_right = at_left;
        at_left = score(left = high - ratio * (high - low));
      }
    }
    kappa = left;
    part.tau = TauBeside(w, kappa);
  }
  const Eigen::Vector3d push = w * r;
  part.pull = push.head<2>() - part.tau * r.head<2>();
  // The parabola is 0.5 kappa (angle - vertex)^2, less a constant.
  const double away = push[2] / kappa, vertex = r[2] - away;
  const double touching = std::min(std::abs(away), kLargestAngle);
  const double weight = Steepening(touching);
  const double c = std::cos(vertex), s = std::sin(vertex);
  part.turn << c, -s, s, c;
  part.turn *= 0.25 * kappa * weight;
  if (touching < std::abs(away)) {
    part.is_exact = false;
    part.shortfall =
        0.5 * kappa *
        (away * away - touching * touching - weight * (std::cos(touching) - std::cos(away)));
  }
  return part;
}

// q' G q of a unit quaternion q = [v, w], in blocks of G.
struct OfQuaternion {
  Eigen::Matrix3d vv = Eigen::Matrix3d::Zero();
  Eigen::Vector3d vw = Eigen::Vector3d::Zero();
  double ww = 0;

  // Less (v - w slope)' H (v - w slope).
  void Reduce(const Eigen::Matrix3d& h, const Eigen::Vector3d& slope) {
    vv -= h;
    vw += h * slope;
    ww -= slope.dot(h * slope);
  }

  // As -<turn, R> and a constant: from R = (w^2 - |v|^2) 1 + 2 v v' + 2 w [v]x.
  Eigen::Matrix3d Turn() const {
    return 0.25 * (vv.trace() - ww) * Eigen::Matrix3d::Identity() - 0.5 * vv -
           0.5 * Eigen::Matrix3d(Skew(vw));
  }
};

// Where minorants of rotations touch: at the unit quaternion [v, w], w >= 0.
struct Touching {
  Eigen::Vector3d v, slope;
  double w;

  explicit Touching(const Eigen::Vector3d& at)
      : v(at), w(std::sqrt(std::max(0.0, 1 - at.squaredNorm()))) {
    slope = v / std::max(w, kSmallestScalar);
  }
  bool IsHalfTurn() const { return w < kSmallestScalar; }
};

// v' K v is quadratic in the quaternion as it is.  Lifted, where determinants count for nothing, it
// holds better as k |v|^2, with k the smallest eigenvalue of K, and the rest less what vanishes
// doubly where it touches.
void AddSquare(const Eigen::Matrix3d& weight, const Touching& at, Part<3>* part) {
  OfQuaternion of;
  of.vv = weight;
  if (!IsScalar(weight)) {
    const Eigen::Matrix3d rest = weight - Smallest(weight) * Eigen::Matrix3d::Identity();
    of.Reduce(rest, at.slope);
    if (at.IsHalfTurn()) {
      const Eigen::Vector3d missed = at.v - at.w * at.slope;
      part->shortfall += missed.dot(rest * missed);
      part->is_exact = false;
    }
  }
  part->turn += of.Turn();
}

// c' (turn), of the quaternion's vector part or of the rotation vector; not at a half turn.
// docs/certificate.md derives beta, gamma and the rest.
void AddLinear(const Eigen::Vector3d& c, const Touching& at, bool of_angle, Part<3>* part) {
  double phi = 1, slope = 0, steepest = 0, most_bent = 0;  // |turn| / |v|, and of it by w
  if (of_angle) {
    const double sine = at.v.norm();
    phi = sine > 1e-4 ? 2 * std::acos(at.w) / sine : 2 + sine * sine / 3;
    slope = (sine > 1e-3 ? (at.w * phi - 2) / (sine * sine) : -2.0 / 3) * at.w / phi;
    steepest = 2 * at.w / phi;
    most_bent = M_PI * at.w / phi;
  }
  const double there = c.dot(at.v), beta = (1 - slope) / 2;
  const double gamma = there > 0 ? 1 + steepest - beta : std::max(0.0, beta - 1 + most_bent / 2);
  OfQuaternion of;
  of.vw = c / (2 * at.w);
  of.vv = beta * there * Eigen::Matrix3d::Identity();
  of.ww = beta * there * (1 - 1 / (at.w * at.w));
  Eigen::Matrix3d h = std::abs(there) * gamma * Eigen::Matrix3d::Identity();
  if (const double size = c.norm(); size > 0)
    h += 0.5 * (1 + steepest) * (size * Eigen::Matrix3d::Identity() + c * c.transpose() / size);
  of.Reduce(h, at.slope);
  part->turn += phi * of.Turn();
}

// r' K r of a rotation vector.
void AddAngle(const Eigen::Matrix3d& weight, const Eigen::Vector3d& r, const Touching& at,
              Part<3>* part) {
  // Of the smallest weight the angle as in the plane, exactly.
  const double kappa = IsScalar(weight) ? weight(0, 0) : Smallest(weight);
  const double angle = r.norm(), touching = std::min(angle, kLargestAngle);
  const double steepening = Steepening(touching);
  part->turn += 0.25 * kappa * steepening * Eigen::Matrix3d::Identity();
  if (touching < angle) {
    part->is_exact = false;
    part->shortfall +=
        0.5 * kappa *
        (angle * angle - touching * touching - steepening * (std::cos(touching) - std::cos(angle)));
  }
  if (IsScalar(weight)) return;
  // Of the rest, |r|^2 >= 4 |v|^2 (1 + |v|^2 / 3), and of the product |v|^2 (v' rest v), a sum of
  // squares, the tangent.
  const Eigen::Matrix3d rest = weight - kappa * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d pulled = rest * at.v;
  AddSquare(2 * rest + 2.0 / 3 * (at.v * pulled.transpose() + pulled * at.v.transpose()), at, part);
  part->is_exact = false;
  part->shortfall += 0.5 * r.dot(rest * r) - 2 * at.v.dot(pulled) * (1 + at.v.squaredNorm() / 3);
}

// Space: 0.5 r' W r >= 0.5 e' T e + 0.5 turn' K turn + z' N r - 0.5 z' N z with N = W - diag(T, K),
// none of them indefinite, and z = r where it touches.
Part<3> SpatialMinorant(const Statement<3>& statement, const Eigen::Matrix<double, 6, 1>& r) {
  const auto& w = statement.w;
  const Eigen::Vector3d e = r.head<3>(), turn = r.tail<3>();
  const bool of_angle = statement.turn == Program<3>::Turn::kAngle;
  Part<3> part;
  if (statement.turn == Program<3>::Turn::kNone) {
    const Eigen::Matrix3d we = w.topLeftCorner<3, 3>();
    part.tau = IsScalar(we) ? we(0, 0) : Smallest(we);
    part.pull = we * e - part.tau * e;
    return part;
  }
  Eigen::Matrix3d we = w.topLeftCorner<3, 3>(), wv = w.bottomRightCorner<3, 3>();
  const double half = turn.norm() / 2;
  const double sinc = half > 1e-4 ? std::sin(half) / half : 1 - half * half / 6;
  const Touching at(of_angle ? Eigen::Vector3d(0.5 * sinc * turn) : turn);
  Eigen::Matrix<double, 6, 1> push = w * r;
  if (statement.couples) {
    // K = (1 - s) W_turn, s the largest canonical correlation; T is what that leaves.
    const Eigen::Matrix3d coupling = w.topRightCorner<3, 3>();
    const Eigen::Matrix3d by_turn = coupling * wv.ldlt().solve(coupling.transpose());
    const double s = std::sqrt(std::max(
        0.0,
        Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix3d>(by_turn, we).eigenvalues()[2]));
    if (s > 0) we -= by_turn / s;
    wv *= 1 - s;
    if (at.IsHalfTurn()) {
      part.is_exact = false;
      part.shortfall = 0.5 * (r.dot(push) - e.dot(we * e) - turn.dot(wv * turn));
      push.head<3>() = we * e;
    } else {
      AddLinear(push.tail<3>() - wv * turn, at, of_angle, &part);
    }
  }
  part.tau = IsScalar(we) ? we(0, 0) : Smallest(we);
  part.pull = push.head<3>() - part.tau * e;
  if (of_angle)
    AddAngle(wv, turn, at, &part);
  else
    AddSquare(0.5 * wv, at, &part);
  return part;
}

template <int kDim>
Part<kDim> Chordal(const Statement<kDim>& statement) {
  constexpr int kTurn = Program<kDim>::kTurn;
  Part<kDim> part;
  const Matrix<kDim> we = statement.w.template topLeftCorner<kDim, kDim>();
  part.tau = kDim / we.inverse().trace();
  if (statement.turn == Program<kDim>::Turn::kNone) return part;
  const Eigen::Matrix<double, kTurn, kTurn> wv =
      statement.w.template bottomRightCorner<kTurn, kTurn>();
  double kappa = kTurn / wv.inverse().trace();  // of the angle's square
  if (statement.turn == Program<kDim>::Turn::kQuaternion) kappa /= 4;
  part.turn = 0.5 * kappa * Matrix<kDim>::Identity();
  return part;
}

// The part in terms of [t_a R_a] and [t_b R_b].  `as_square`: of the turn the whole distance, with
// what is constant for rotations.
template <int kDim>
typename Quadratic<kDim>::Term TermOf(const Statement<kDim>& statement, const Part<kDim>& part,
                                      bool as_square) {
  using Tall = Eigen::Matrix<double, kDim + 1, 1>;
  using Select = Eigen::Matrix<double, kDim + 1, kDim>;
  const Matrix<kDim>& a_turn = statement.a_offset.rotation;
  // t_b' - t_a' - R_a' t_m = X_a of_a + X_b of_b, R_a' R_m = X_a frame, R_b' = X_b frame_b.
  Tall of_a, of_b;
  of_a << -1, -(statement.a_offset.translation + a_turn * statement.measured.translation);
  of_b << 1, statement.b_offset.translation;
  Select frame = Select::Zero(), frame_b = Select::Zero();
  frame.template bottomRows<kDim>() = a_turn * statement.measured.rotation;
  frame_b.template bottomRows<kDim>() = statement.b_offset.rotation;

  typename Quadratic<kDim>::Term term;
  term.a = statement.a;
  term.b = statement.b;
  const Tall pulled = frame * part.pull;
  term.aa =
      part.tau * of_a * of_a.transpose() + pulled * of_a.transpose() + of_a * pulled.transpose();
  term.bb = part.tau * of_b * of_b.transpose();
  term.ab = part.tau * of_a * of_b.transpose() + pulled * of_b.transpose();
  if (statement.turn != Program<kDim>::Turn::kNone)
    term.ab -= frame * part.turn * frame_b.transpose();
  if (as_square) {
    term.aa += frame * part.turn * frame.transpose();
    term.bb += frame_b * part.turn * frame_b.transpose();
  }
  return term;
}

}  // namespace

template <int kDim>
Poses<kDim> Quadratic<kDim>::Times(const Poses<kDim>& poses) const {
  Poses<kDim> product = Poses<kDim>::Zero(poses.rows(), poses.cols());
  for (const Term& term : terms) {
    const auto a = poses.template middleCols<kDim + 1>((kDim + 1) * term.a);
    const auto b = poses.template middleCols<kDim + 1>((kDim + 1) * term.b);
    auto to_a = product.template middleCols<kDim + 1>((kDim + 1) * term.a);
    auto to_b = product.template middleCols<kDim + 1>((kDim + 1) * term.b);
    to_a.noalias() += a.lazyProduct(term.aa);
    to_a.noalias() += b.lazyProduct(term.ab.transpose());
    to_b.noalias() += a.lazyProduct(term.ab);
    to_b.noalias() += b.lazyProduct(term.bb);
  }
  return product;
}

template <int kDim>
std::vector<typename Quadratic<kDim>::Block> Quadratic<kDim>::Diagonal(std::size_t nodes) const {
  std::vector<Block> diagonal(nodes, Block::Zero());
  for (const Term& term : terms) {
    diagonal[static_cast<std::size_t>(term.a)] += term.aa;
    diagonal[static_cast<std::size_t>(term.b)] += term.bb;
  }
  return diagonal;
}

template <int kDim>
StandInResult<kDim> MakeStandIn(const Program<kDim>& program, const Poses<kDim>& poses,
                                StandIn kind) {
  StandInResult<kDim> result;
  result.cost = program.constant;
  result.quadratic.terms.reserve(program.statements.size());
  for (const Statement<kDim>& statement : program.statements) {
    const auto r = ResidualOf<kDim>(statement, poses);
    result.cost += 0.5 * r.dot(statement.w * r);
    Part<kDim> part;
    if (kind == StandIn::kChordal)
      part = Chordal<kDim>(statement);
    else if constexpr (kDim == 2)
      part = PlanarMinorant(statement, r);
    else
      part = SpatialMinorant(statement, r);
    result.shortfall += part.shortfall;
    result.exact += part.is_exact;
    result.quadratic.terms.push_back(TermOf<kDim>(statement, part, kind == StandIn::kChordal));
  }
  return result;
}

template struct Quadratic<2>;
template struct Quadratic<3>;
template StandInResult<2> MakeStandIn<2>(const Program<2>&, const Poses<2>&, StandIn);
template StandInResult<3> MakeStandIn<3>(const Program<3>&, const Poses<3>&, StandIn);

}  // namespace graticule
