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

constexpr double kLargestAngle = 0.9 * M_PI;

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

// What q' G q says of a unit quaternion q = [v, w], as -<turn, R> and a constant: from
// R = (w^2 - |v|^2) I + 2 v v' + 2 w [v]x.
Eigen::Matrix3d TurnOf(const Eigen::Matrix3d& vv, const Eigen::Vector3d& vw, double ww) {
  Eigen::Matrix3d turn = 0.25 * vv.trace() * Eigen::Matrix3d::Identity() - 0.5 * vv;
  turn -= 0.25 * ww * Eigen::Matrix3d::Identity();
  turn -= 0.5 * Eigen::Matrix3d(Skew(vw));
  return turn;
}

// v' K v of a quaternion [v, w] is quadratic in it, and so linear in R.  Lifted, where determinants
// count for nothing, it holds better as the smallest eigenvalue k of K times |v|^2 less what
// vanishes doubly at the quaternion [at, .]: of each axis u of K that is left over, (u' v - w u' at
// / w_at)^2.
Eigen::Matrix3d OfQuaternion(const Eigen::Matrix3d& weight, const Eigen::Vector3d& at) {
  if (IsScalar(weight)) return TurnOf(weight, Eigen::Vector3d::Zero(), 0);
  const double k = Smallest(weight);
  const Eigen::Matrix3d rest = weight - k * Eigen::Matrix3d::Identity();
  const double w_at = std::sqrt(std::max(0.0, 1 - at.squaredNorm()));
  const Eigen::Vector3d slope = at / w_at;
  return TurnOf(weight - rest, rest * slope, -slope.dot(rest * slope));
}

// Space: e and the turn each by itself.
Part<3> SpatialMinorant(const Statement<3>& statement, const Eigen::Matrix<double, 6, 1>& r) {
  const auto& w = statement.w;
  Eigen::Matrix3d we = w.topLeftCorner<3, 3>(), wv = w.bottomRightCorner<3, 3>();
  const Eigen::Vector3d e = r.head<3>(), v = r.tail<3>();
  Part<3> part;
  if (statement.couples) {
    // W >= diag(we', (1 - s) wv) with s the largest canonical correlation.
    const Eigen::Matrix3d coupling = w.topRightCorner<3, 3>();
    const Eigen::Matrix3d by_v = coupling * wv.ldlt().solve(coupling.transpose());
    const double s = std::sqrt(std::max(
        0.0, Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix3d>(by_v, we).eigenvalues()[2]));
    if (s > 0) we -= by_v / s;
    wv *= 1 - s;
    part.is_exact = false;
    part.shortfall = 0.5 * (r.dot(w * r) - e.dot(we * e) - v.dot(wv * v));
  }
  part.tau = IsScalar(we) ? we(0, 0) : Smallest(we);
  part.pull = we * e - part.tau * e;
  if (statement.turn == Program<3>::Turn::kNone) return part;
  if (statement.turn == Program<3>::Turn::kQuaternion) {
    part.turn = OfQuaternion(0.5 * wv, v);
    return part;
  }
  // The rotation vector: of its smallest weight the angle as in the plane, exactly.
  const double kappa = IsScalar(wv) ? wv(0, 0) : Smallest(wv);
  const double angle = v.norm(), touching = std::min(angle, kLargestAngle);
  const double weight = Steepening(touching);
  part.turn = 0.25 * kappa * weight * Eigen::Matrix3d::Identity();
  if (touching < angle) {
    part.is_exact = false;
    part.shortfall +=
        0.5 * kappa *
        (angle * angle - touching * touching - weight * (std::cos(touching) - std::cos(angle)));
  }
  if (IsScalar(wv)) return part;
  const Eigen::Matrix3d rest = wv - kappa * Eigen::Matrix3d::Identity();
  // Of the rest, by the quaternion's vector part u: |v| >= 2 |u| (1 + |u|^2 / 6), and of the
  // product |u|^2 (u' rest u), a sum of squares, the tangent.
  const double half = angle / 2, sinc = half > 1e-4 ? std::sin(half) / half : 1 - half * half / 6;
  const Eigen::Vector3d u = 0.5 * sinc * v, pulled = rest * u;
  part.turn +=
      OfQuaternion(2 * rest + 2.0 / 3 * (u * pulled.transpose() + pulled * u.transpose()), u);
  part.is_exact = false;
  part.shortfall += 0.5 * v.dot(rest * v) - 2 * u.dot(pulled) * (1 + u.squaredNorm() / 3);
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

// The part in terms of [t_a R_a] and [t_b R_b].
template <int kDim>
typename Quadratic<kDim>::Term TermOf(const Statement<kDim>& statement, const Part<kDim>& part) {
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
    if (kind == StandIn::kChordal) result.constant += part.turn.trace();
    result.shortfall += part.shortfall;
    result.exact += part.is_exact;
    result.quadratic.terms.push_back(TermOf<kDim>(statement, part));
  }
  return result;
}

template struct Quadratic<2>;
template struct Quadratic<3>;
template StandInResult<2> MakeStandIn<2>(const Program<2>&, const Poses<2>&, StandIn);
template StandInResult<3> MakeStandIn<3>(const Program<3>&, const Poses<3>&, StandIn);

}  // namespace graticule
