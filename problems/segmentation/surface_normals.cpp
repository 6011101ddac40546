#include "graticule/problems/segmentation/surface_normals.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "graticule/problems/segmentation/wide_loop.hpp"

namespace graticule {
namespace {

// Sums over points, of their places relative to the window's middle: 1, x, y, z, xx, xy, xz, yy,
// yz, zz.
constexpr std::size_t kMoments = 10;

struct Moments {
  float *n, *x, *y, *z, *xx, *xy, *xz, *yy, *yz, *zz;
  Moments(float* first, std::size_t width)
      : n(first),
        x(n + width),
        y(x + width),
        z(y + width),
        xx(z + width),
        xy(xx + width),
        xz(xy + width),
        yy(xz + width),
        yz(yy + width),
        zz(yz + width) {}
};

// Adds the points `away` places further along a row, where `reach` goes on.
GRATICULE_WIDE inline void AddPoints(const float* px, const float* py, const float* pz,
                                     std::ptrdiff_t away, const float* reach, std::size_t first,
                                     std::size_t last, Moments& to) {
  float *n = to.n, *x = to.x, *y = to.y, *z = to.z;
  float *xx = to.xx, *xy = to.xy, *xz = to.xz, *yy = to.yy, *yz = to.yz, *zz = to.zz;
#pragma GCC ivdep
  for (std::size_t c = first; c < last; ++c) {
    const float w = reach[c];
    const float dx = px[c + away] - px[c], dy = py[c + away] - py[c], dz = pz[c + away] - pz[c];
    const float wx = w * dx, wy = w * dy, wz = w * dz;
    n[c] += w;
    x[c] += wx;
    y[c] += wy;
    z[c] += wz;
    xx[c] += wx * dx;
    xy[c] += wx * dy;
    xz[c] += wx * dz;
    yy[c] += wy * dy;
    yz[c] += wy * dz;
    zz[c] += wz * dz;
  }
}

// Adds the sums of another row, moved from its own points to this row's.
GRATICULE_WIDE inline void AddSums(const float* px, const float* py, const float* pz,
                                   std::ptrdiff_t away, const float* reach, std::size_t count,
                                   const Moments& other, Moments& to) {
  float *n = to.n, *x = to.x, *y = to.y, *z = to.z;
  float *xx = to.xx, *xy = to.xy, *xz = to.xz, *yy = to.yy, *yz = to.yz, *zz = to.zz;
  const float *on = other.n, *ox = other.x, *oy = other.y, *oz = other.z;
  const float *oxx = other.xx, *oxy = other.xy, *oxz = other.xz, *oyy = other.yy, *oyz = other.yz,
              *ozz = other.zz;
#pragma GCC ivdep
  for (std::size_t c = 0; c < count; ++c) {
    const float w = reach[c];
    const std::ptrdiff_t there = static_cast<std::ptrdiff_t>(c) + away;
    const float dx = px[there] - px[c], dy = py[there] - py[c], dz = pz[there] - pz[c];
    const float m = on[c];
    const float mx = ox[c] + m * dx, my = oy[c] + m * dy, mz = oz[c] + m * dz;
    n[c] += w * m;
    x[c] += w * mx;
    y[c] += w * my;
    z[c] += w * mz;
    xx[c] += w * (oxx[c] + dx * (ox[c] + mx));
    xy[c] += w * (oxy[c] + dx * oy[c] + dy * mx);
    xz[c] += w * (oxz[c] + dx * oz[c] + dz * mx);
    yy[c] += w * (oyy[c] + dy * (oy[c] + my));
    yz[c] += w * (oyz[c] + dy * oz[c] + dz * my);
    zz[c] += w * (ozz[c] + dz * (oz[c] + mz));
  }
}

// A symmetric matrix.
struct Matrix3 {
  float xx, xy, xz, yy, yz, zz;
};

// Its adjugate: the same eigenvectors, with the products of the two other eigenvalues.
GRATICULE_WIDE inline Matrix3 Adjugate(const Matrix3& m) {
  return {m.yy * m.zz - m.yz * m.yz, m.xz * m.yz - m.xy * m.zz, m.xy * m.yz - m.xz * m.yy,
          m.xx * m.zz - m.xz * m.xz, m.xy * m.xz - m.xx * m.yz, m.xx * m.yy - m.xy * m.xy};
}

GRATICULE_WIDE inline Matrix3 Square(const Matrix3& m) {
  return {m.xx * m.xx + m.xy * m.xy + m.xz * m.xz, m.xx * m.xy + m.xy * m.yy + m.xz * m.yz,
          m.xx * m.xz + m.xy * m.yz + m.xz * m.zz, m.xy * m.xy + m.yy * m.yy + m.yz * m.yz,
          m.xy * m.xz + m.yy * m.yz + m.yz * m.zz, m.xz * m.xz + m.yz * m.yz + m.zz * m.zz};
}

GRATICULE_WIDE inline float Trace(const Matrix3& m) { return m.xx + m.yy + m.zz; }

GRATICULE_WIDE inline Matrix3 Scaled(const Matrix3& m, float by) {
  return {m.xx * by, m.xy * by, m.xz * by, m.yy * by, m.yz * by, m.zz * by};
}

// Below this share of the squared trace, a window's points lie on a line (adjugate of a plane of
// equal spreads: a quarter).
constexpr float kLine = 1e-5f;
// A projector onto one direction, squared, has trace one.
constexpr float kOneDirection = 0.9999f;

}  // namespace

Eigen::Vector3f LeastDirection(const float* c) {
  Eigen::Matrix3f matrix;
  matrix << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f>(matrix).eigenvectors().col(0);
}

void SurfaceNormals::SumRow(const ScanMesh& mesh, std::size_t row, float* sums) {
  const std::size_t width = mesh.Width(), i = row * width;
  Moments to(sums, width);
  std::fill(sums, sums + width, 1.0f);
  std::fill(sums + width, sums + kMoments * width, 0.0f);
  const std::uint8_t* links = mesh.Links() + i;
  const float *x = mesh.X() + i, *y = mesh.Y() + i, *z = mesh.Z() + i;
  float* reach = reach_.data();
  for (const int side : {1, -1}) {
    std::fill(reach, reach + width, 1.0f);
    for (int k = 1; k <= radius_ && static_cast<std::size_t>(k) < width; ++k) {
      const std::size_t step = static_cast<std::size_t>(k);
      const std::size_t first = side > 0 ? 0 : step, last = side > 0 ? width - step : width;
      // The link between the last point reached and the next.
      const std::uint8_t* link = side > 0 ? links + step - 1 : links - step;
      for (std::size_t c = first; c < last; ++c)
        reach[c] = (link[c] >> ScanMesh::kRight & 1) != 0 ? reach[c] : 0.0f;
      RunWide([&]() GRATICULE_WIDE { AddPoints(x, y, z, side * k, reach, first, last, to); });
    }
  }
}

void SurfaceNormals::SumColumns(const ScanMesh& mesh, std::size_t row) {
  const std::size_t width = mesh.Width(), i = row * width;
  const std::size_t kept = 2 * static_cast<std::size_t>(radius_) + 1;
  const float* own = &row_sums_[row % kept * kMoments * width];
  std::copy(own, own + kMoments * width, sums_.begin());
  Moments to(sums_.data(), width);
  const float *x = mesh.X() + i, *y = mesh.Y() + i, *z = mesh.Z() + i;
  float* reach = reach_.data();
  for (const int side : {1, -1}) {
    std::fill(reach, reach + width, 1.0f);
    for (int k = 1; k <= radius_; ++k) {
      const std::ptrdiff_t other = static_cast<std::ptrdiff_t>(row) + side * k;
      if (other < 0 || other >= static_cast<std::ptrdiff_t>(mesh.Height())) break;
      const std::size_t upper = static_cast<std::size_t>(side > 0 ? other - 1 : other);
      const std::uint8_t* link = mesh.Links() + upper * width;
      for (std::size_t c = 0; c < width; ++c)
        reach[c] = (link[c] >> ScanMesh::kDown & 1) != 0 ? reach[c] : 0.0f;
      const Moments from(&row_sums_[static_cast<std::size_t>(other) % kept * kMoments * width],
                         width);
      RunWide([&]() GRATICULE_WIDE {
        AddSums(x, y, z, side * k * static_cast<std::ptrdiff_t>(width), reach, width, from, to);
      });
    }
  }
}

void SurfaceNormals::FitRow(const ScanMesh& mesh, std::size_t row) {
  const std::size_t width = mesh.Width(), i = row * width;
  const Moments sum(sums_.data(), width);
  const float *px = mesh.X() + i, *py = mesh.Y() + i, *pz = mesh.Z() + i;
  float *nx = &x_[i], *ny = &y_[i], *nz = &z_[i], *roughness = &roughness_[i];
  float* is_clear = reach_.data();
  const float *sn = sum.n, *sx = sum.x, *sy = sum.y, *sz = sum.z, *sxx = sum.xx, *sxy = sum.xy,
              *sxz = sum.xz, *syy = sum.yy, *syz = sum.yz, *szz = sum.zz;
  RunWide([=]() GRATICULE_WIDE {
#pragma GCC ivdep
    for (std::size_t c = 0; c < width; ++c) {
      const float share = 1 / sn[c];
      const float mx = sx[c] * share, my = sy[c] * share, mz = sz[c] * share;
      const Matrix3 spread = {sxx[c] * share - mx * mx, sxy[c] * share - mx * my,
                              sxz[c] * share - mx * mz, syy[c] * share - my * my,
                              syz[c] * share - my * mz, szz[c] * share - mz * mz};
      const float trace = Trace(spread);
      const Matrix3 unit = Scaled(spread, 1 / std::max(trace, 1e-30f));
      const Matrix3 adjugate = Adjugate(unit);
      const float area = Trace(adjugate);
      // Powers of the adjugate tend to the projector onto the normal; eight times the ratio's
      // power.
      Matrix3 power = Scaled(adjugate, 1 / std::max(area, 1e-30f));
      for (int k = 0; k < 6; ++k) {
        power = Square(power);
        power = Scaled(power, 1 / std::max(Trace(power), 1e-30f));
      }
      const float clear = Trace(Square(power));
      // The column of the largest diagonal.
      const bool is_x = (power.xx >= power.yy) & (power.xx >= power.zz);
      const bool is_y = power.yy >= power.zz;
      float vx = is_x ? power.xx : (is_y ? power.xy : power.xz);
      float vy = is_x ? power.xy : (is_y ? power.yy : power.yz);
      float vz = is_x ? power.xz : (is_y ? power.yz : power.zz);
      const bool is_surface = (sn[c] > 2.5f) & (area > kLine);
      const float length2 = vx * vx + vy * vy + vz * vz;
      const float towards = vx * px[c] + vy * py[c] + vz * pz[c];
      float scale = 1 / std::sqrt(std::max(length2, 1e-30f));
      scale = towards > 0 ? -scale : scale;
      // By choice, not by a factor of zero: powers of next to nothing may be no numbers.
      vx = is_surface ? vx * scale : 0.0f;
      vy = is_surface ? vy * scale : 0.0f;
      vz = is_surface ? vz * scale : 0.0f;
      nx[c] = vx;
      ny[c] = vy;
      nz[c] = vz;
      // The least eigenvalue: the normal's Rayleigh quotient.
      const float least = vx * (spread.xx * vx + 2 * (spread.xy * vy + spread.xz * vz)) +
                          vy * (spread.yy * vy + 2 * spread.yz * vz) + vz * spread.zz * vz;
      roughness[c] = std::sqrt(std::max(least, 0.0f));
      is_clear[c] = (clear > kOneDirection) | !is_surface ? 1.0f : 0.0f;
    }
  });
  for (std::size_t c = 0; c < width; ++c) {
    if (is_clear[c] != 0) continue;
    const float share = 1 / sn[c];
    const float mx = sx[c] * share, my = sy[c] * share, mz = sz[c] * share;
    const float spread[] = {sxx[c] * share - mx * mx, sxy[c] * share - mx * my,
                            sxz[c] * share - mx * mz, syy[c] * share - my * my,
                            syz[c] * share - my * mz, szz[c] * share - mz * mz};
    Eigen::Vector3f normal = LeastDirection(spread);
    if (normal.dot(Eigen::Vector3f(px[c], py[c], pz[c])) > 0) normal = -normal;
    nx[c] = normal.x();
    ny[c] = normal.y();
    nz[c] = normal.z();
  }
}

void SurfaceNormals::Begin(std::size_t width, int radius) {
  radius_ = std::clamp(radius, 1, kLargestRadius);
  rows_ = summed_ = 0;
  for (std::vector<float>* list : {&x_, &y_, &z_, &roughness_}) list->clear();
  row_sums_.resize((2 * static_cast<std::size_t>(radius_) + 1) * kMoments * width);
  sums_.resize(kMoments * width);
  reach_.resize(width);
}

void SurfaceNormals::FitUntil(const ScanMesh& mesh, std::size_t end) {
  const std::size_t width = mesh.Width(), reach = static_cast<std::size_t>(radius_);
  const std::size_t kept = 2 * reach + 1;
  if (rows_ < end)
    for (std::vector<float>* list : {&x_, &y_, &z_, &roughness_}) list->resize(end * width);
  for (; rows_ < end; ++rows_) {
    for (; summed_ < mesh.Height() && summed_ <= rows_ + reach; ++summed_)
      SumRow(mesh, summed_, &row_sums_[summed_ % kept * kMoments * width]);
    SumColumns(mesh, rows_);
    FitRow(mesh, rows_);
  }
}

void SurfaceNormals::Extend(const ScanMesh& mesh) {
  const std::size_t reach = static_cast<std::size_t>(radius_);
  if (mesh.Height() > reach) FitUntil(mesh, mesh.Height() - reach);
}

void SurfaceNormals::Finish(const ScanMesh& mesh) { FitUntil(mesh, mesh.Height()); }

void SurfaceNormals::Compute(const ScanMesh& mesh, int radius) {
  Begin(mesh.Width(), radius);
  Finish(mesh);
}

}  // namespace graticule
