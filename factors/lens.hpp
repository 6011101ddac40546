#pragma once

#include <array>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <type_traits>

#include "graticule/factors/lie.hpp"

namespace graticule {

/// Words put together while compiling; a zero ends them.
template <std::size_t kSize>
constexpr std::array<char, kSize> TextOf(std::initializer_list<std::string_view> words) {
  std::array<char, kSize> text = {};
  std::size_t i = 0;
  for (const std::string_view word : words)
    for (const char c : word) text[i++] = c;
  return text;
}

constexpr std::string_view Digit(int number) {
  return std::string_view("0123456789").substr(static_cast<std::size_t>(number), 1);
}

/// How a lens bends rays: a point in the camera's frame (x right, y down, z forward) [m] to the
/// plane at focal length 1.  Each is a struct with kName, kTerms (numbers beside fx fy cx cy),
/// kFields, and
///
///     static bool Bend(const double* terms, const double* point, double* bent,
///                      double* by_point, double* by_terms)
///
/// with row-major derivatives, 2 x 3 and 2 x kTerms, or null where they are not wanted.  False
/// where the model has no image of the point.  It may have kSeesBehind, true where there are images
/// of points with z <= 0, and kStart, the terms that a fit begins from where zeros do not do.  A
/// plug-in's lens has the same form; the factors (reprojection.hpp) are made from it.

namespace lens {

/// Writes the image of a plane point q(x/z, y/z), its derivatives in `by_plane` (2 x 2), as one of
/// the point in space.
inline void ThroughPlane(double x, double y, double inverse_depth, const double by_plane[4],
                         double* by_point) {
  for (int row = 0; row < 2; ++row) {
    const double a = by_plane[2 * row] * inverse_depth, b = by_plane[2 * row + 1] * inverse_depth;
    by_point[3 * row] = a;
    by_point[3 * row + 1] = b;
    by_point[3 * row + 2] = -(a * x + b * y);
  }
}

/// Whether a lens has images of points with z <= 0: its kSeesBehind, if it has one.
template <class Lens, class = void>
struct SeesBehind : std::false_type {};
template <class Lens>
struct SeesBehind<Lens, std::void_t<decltype(Lens::kSeesBehind)>>
    : std::bool_constant<Lens::kSeesBehind> {};

/// The terms that a fit begins from: a lens' kStart, or zeros (null).
template <class Lens, class = void>
struct Start {
  static constexpr const double* kTerms = nullptr;
};
template <class Lens>
struct Start<Lens, std::void_t<decltype(Lens::kStart)>> {
  static_assert(sizeof(Lens::kStart) == sizeof(double) * Lens::kTerms, "kStart: one a term");
  static constexpr const double* kTerms = Lens::kStart;
};

/// True for points that a camera which looks along z through a plane can see.
inline bool IsInFront(const double* point) { return point[2] > 1e-9; }

}  // namespace lens

/// No distortion.
struct PinholeLens {
  static constexpr const char* kName = "pinhole";
  static constexpr const char* kFields = "fx:px fy:px cx:px cy:px";
  static constexpr int kTerms = 0;

  static bool Bend(const double*, const double* point, double* bent, double* by_point, double*) {
    if (!lens::IsInFront(point)) return false;
    const double inverse = 1 / point[2];
    bent[0] = point[0] * inverse;
    bent[1] = point[1] * inverse;
    constexpr double kIdentity[4] = {1, 0, 0, 1};
    if (by_point) lens::ThroughPlane(bent[0], bent[1], inverse, kIdentity, by_point);
    return true;
  }
};

/// Brown-Conrady: radial and tangential terms on the plane at focal length 1, with
/// s = x^2 + y^2, R = (1 + k1 s + k2 s^2 + k3 s^3) / (1 + k4 s + k5 s^2 + k6 s^3):
/// x R + 2 p1 x y + p2 (s + 2 x^2), y R + p1 (s + 2 y^2) + 2 p2 x y.
/// Names, signs and order of the terms as OpenCV's calibrateCamera.  `Slots` says which there are.
template <class Slots>
struct BrownLens : Slots {
  static constexpr int kTerms = static_cast<int>(sizeof(Slots::kSlots) / sizeof(int));

  static bool Bend(const double* terms, const double* point, double* bent, double* by_point,
                   double* by_terms) {
    if (!lens::IsInFront(point)) return false;
    double k[8] = {};  // k1 k2 p1 p2 k3 k4 k5 k6
    for (int i = 0; i < kTerms; ++i) k[Slots::kSlots[i]] = terms[i];
    const double inverse = 1 / point[2], x = point[0] * inverse, y = point[1] * inverse;
    const double s = x * x + y * y;
    const double above = 1 + s * (k[0] + s * (k[1] + s * k[4]));
    const double below = 1 + s * (k[5] + s * (k[6] + s * k[7]));
    if (!(below > 1e-6)) return false;
    const double radial = above / below;
    bent[0] = x * radial + 2 * k[2] * x * y + k[3] * (s + 2 * x * x);
    bent[1] = y * radial + k[2] * (s + 2 * y * y) + 2 * k[3] * x * y;
    if (by_point) {
      const double above_slope = k[0] + s * (2 * k[1] + 3 * s * k[4]);
      const double below_slope = k[5] + s * (2 * k[6] + 3 * s * k[7]);
      const double slope = 2 * (above_slope - radial * below_slope) / below;  // dR = slope (x, y)
      const double cross = slope * x * y + 2 * k[2] * x + 2 * k[3] * y;
      const double by_plane[4] = {radial + slope * x * x + 2 * k[2] * y + 6 * k[3] * x, cross,
                                  cross, radial + slope * y * y + 6 * k[2] * y + 2 * k[3] * x};
      lens::ThroughPlane(x, y, inverse, by_plane, by_point);
    }
    if (by_terms) {
      const double up = s / below, down = -radial * up;
      const double all[2][8] = {{x * up, x * up * s, 2 * x * y, s + 2 * x * x, x * up * s * s,
                                 x * down, x * down * s, x * down * s * s},
                                {y * up, y * up * s, s + 2 * y * y, 2 * x * y, y * up * s * s,
                                 y * down, y * down * s, y * down * s * s}};
      for (int row = 0; row < 2; ++row)
        for (int i = 0; i < kTerms; ++i) by_terms[row * kTerms + i] = all[row][Slots::kSlots[i]];
    }
    return true;
  }
};

struct Radial2Slots {
  static constexpr const char* kName = "radial2";
  static constexpr const char* kFields = "fx:px fy:px cx:px cy:px k1 k2";
  static constexpr int kSlots[] = {0, 1};
};
/// Thesis, Table 5.1: "Radial, 3 distortion terms".
struct Radial3Slots {
  static constexpr const char* kName = "radial3";
  static constexpr const char* kFields = "fx:px fy:px cx:px cy:px k1 k2 k3";
  static constexpr int kSlots[] = {0, 1, 4};
};
struct Brown4Slots {
  static constexpr const char* kName = "brown4";
  static constexpr const char* kFields = "fx:px fy:px cx:px cy:px k1 k2 p1 p2";
  static constexpr int kSlots[] = {0, 1, 2, 3};
};
struct Brown5Slots {
  static constexpr const char* kName = "brown5";
  static constexpr const char* kFields = "fx:px fy:px cx:px cy:px k1 k2 p1 p2 k3";
  static constexpr int kSlots[] = {0, 1, 2, 3, 4};
};
struct Brown8Slots {
  static constexpr const char* kName = "brown8";
  static constexpr const char* kFields = "fx:px fy:px cx:px cy:px k1 k2 p1 p2 k3 k4 k5 k6";
  static constexpr int kSlots[] = {0, 1, 2, 3, 4, 5, 6, 7};
};
using Radial2Lens = BrownLens<Radial2Slots>;
using Radial3Lens = BrownLens<Radial3Slots>;
using Brown4Lens = BrownLens<Brown4Slots>;
using Brown5Lens = BrownLens<Brown5Slots>;
using Brown8Lens = BrownLens<Brown8Slots>;

/// Odd polynomial of the angle theta from the optical axis, r = theta + k1 theta^3 + k2 theta^5 +
/// ...: the thesis' model (section 5.1), after Kannala and Brandt (PAMI 2006).  With four terms it
/// is OpenCV's fisheye and Kalibr's equidistant.  Sees behind the camera's plane (Z <= 0), but not
/// straight back.
template <int kCount>
struct AngularLens {
  static_assert(kCount >= 1 && kCount <= 6, "the names below");
  static constexpr int kTerms = kCount;
  static constexpr bool kSeesBehind = true;
  static constexpr auto kNameText = TextOf<16>({"angular", Digit(kCount)});
  static constexpr auto kFieldsText =
      TextOf<64>({std::string_view("fx:px fy:px cx:px cy:px k1 k2 k3 k4 k5 k6", 23 + 3 * kCount)});
  static constexpr const char* kName = kNameText.data();
  static constexpr const char* kFields = kFieldsText.data();

  static bool Bend(const double* terms, const double* point, double* bent, double* by_point,
                   double* by_terms) {
    const double x = point[0], y = point[1], z = point[2];
    const double rho_squared = x * x + y * y, rho = std::sqrt(rho_squared);
    const double squared = rho_squared + z * z;
    if (!(rho > 1e-12 * std::abs(z) || z > 0) || !(squared > 0)) return false;
    const double theta = std::atan2(rho, z), s = theta * theta;
    double polynomial = 0, slope = 0;  // r/theta - 1, dr/dtheta - 1: Horner
    for (int i = kTerms - 1; i >= 0; --i) {
      polynomial = s * (terms[i] + polynomial);
      slope = s * ((2 * i + 3) * terms[i] + slope);
    }
    // theta/rho, which is 1/z on the axis
    const double angle = rho > 1e-9 * std::abs(z) ? theta / rho : 1 / z;
    const double scale = angle * (1 + polynomial);
    bent[0] = scale * x;
    bent[1] = scale * y;
    if (by_point) {
      const double along = (1 + slope) * z / squared;
      const double c = rho > 0 ? (along - scale) / rho_squared : 0;
      const double deep = -(1 + slope) / squared;
      const double values[6] = {scale + c * x * x, c * x * y,         deep * x,
                                c * x * y,         scale + c * y * y, deep * y};
      for (int i = 0; i < 6; ++i) by_point[i] = values[i];
    }
    if (by_terms) {
      double power = angle;
      for (int i = 0; i < kTerms; ++i) {
        power *= s;
        by_terms[i] = power * x;
        by_terms[kTerms + i] = power * y;
      }
    }
    return true;
  }
};

/// Extended unified model (Khomutenko, Garcia, Martinet: An Enhanced Unified Camera Model, RA-L
/// 2016): (x, y) / (alpha d + (1 - alpha) z), d^2 = beta (x^2 + y^2) + z^2.
struct ExtendedUnifiedLens {
  static constexpr const char* kName = "extended_unified";
  static constexpr const char* kFields = "fx:px fy:px cx:px cy:px alpha beta";
  static constexpr int kTerms = 2;
  static constexpr bool kSeesBehind = true;
  static constexpr double kStart[] = {0.5, 1};  // like a fisheye

  static bool Bend(const double* terms, const double* point, double* bent, double* by_point,
                   double* by_terms) {
    const double alpha = terms[0], beta = terms[1];
    const double x = point[0], y = point[1], z = point[2], across = x * x + y * y;
    const double d_squared = beta * across + z * z;
    if (!(d_squared > 0)) return false;
    const double d = std::sqrt(d_squared), n = alpha * d + (1 - alpha) * z;
    // Behind this cone, two rays have one image.
    const double w = alpha > 0.5 ? (1 - alpha) / alpha : alpha / (1 - alpha);
    if (!(n > 1e-9 * d) || !(z > -w * d)) return false;
    const double inverse = 1 / n;
    bent[0] = x * inverse;
    bent[1] = y * inverse;
    if (by_point) {
      const double by_across = alpha * beta / d, by_z = alpha * z / d + 1 - alpha;
      const double values[6] = {inverse - bent[0] * bent[0] * by_across,
                                -bent[0] * bent[1] * by_across,
                                -bent[0] * by_z * inverse,
                                -bent[0] * bent[1] * by_across,
                                inverse - bent[1] * bent[1] * by_across,
                                -bent[1] * by_z * inverse};
      for (int i = 0; i < 6; ++i) by_point[i] = values[i];
    }
    if (by_terms) {
      const double by_alpha = -(d - z) * inverse, by_beta = -alpha * across / (2 * d) * inverse;
      for (int row = 0; row < 2; ++row) {
        by_terms[2 * row] = bent[row] * by_alpha;
        by_terms[2 * row + 1] = bent[row] * by_beta;
      }
    }
    return true;
  }
};

/// Unified model (Mei and Rives 2007, Geyer and Daniilidis 2000) in the form of Usenko et al. 2018:
/// the one above with beta = 1; alpha = xi / (1 + xi).
struct UnifiedLens {
  static constexpr const char* kName = "unified";
  static constexpr const char* kFields = "fx:px fy:px cx:px cy:px alpha";
  static constexpr int kTerms = 1;
  static constexpr bool kSeesBehind = true;
  static constexpr double kStart[] = {0.5};

  static bool Bend(const double* terms, const double* point, double* bent, double* by_point,
                   double* by_terms) {
    const double extended[2] = {terms[0], 1};
    double by_both[4];
    if (!ExtendedUnifiedLens::Bend(extended, point, bent, by_point, by_terms ? by_both : nullptr))
      return false;
    if (by_terms) {
      by_terms[0] = by_both[0];
      by_terms[1] = by_both[2];
    }
    return true;
  }
};

/// Double sphere (Usenko, Demmel, Cremers: The Double Sphere Camera Model, 3DV 2018).
struct DoubleSphereLens {
  static constexpr const char* kName = "double_sphere";
  static constexpr const char* kFields = "fx:px fy:px cx:px cy:px xi alpha";
  static constexpr int kTerms = 2;
  static constexpr bool kSeesBehind = true;
  static constexpr double kStart[] = {0, 0.5};

  static bool Bend(const double* terms, const double* point, double* bent, double* by_point,
                   double* by_terms) {
    const double xi = terms[0], alpha = terms[1];
    const double x = point[0], y = point[1], z = point[2], across = x * x + y * y;
    const double d1 = std::sqrt(across + z * z);
    if (!(d1 > 0)) return false;
    const double shifted = xi * d1 + z, d2 = std::sqrt(across + shifted * shifted);
    const double n = alpha * d2 + (1 - alpha) * shifted;
    const double w1 = alpha > 0.5 ? (1 - alpha) / alpha : alpha / (1 - alpha);
    const double w2 = (w1 + xi) / std::sqrt(2 * w1 * xi + xi * xi + 1);
    if (!(n > 1e-9 * d1) || !(z > -w2 * d1)) return false;
    const double inverse = 1 / n;
    bent[0] = x * inverse;
    bent[1] = y * inverse;
    if (by_point) {
      // dn/d(x, y, z): shifted changes by xi (x, y, z)/d1 + (0, 0, 1)
      const double by_shift = alpha * shifted / d2 + 1 - alpha;
      const double by_across = alpha / d2 + by_shift * xi / d1;
      const double slope[3] = {by_across * x, by_across * y, by_shift * (xi * z / d1 + 1)};
      for (int row = 0; row < 2; ++row)
        for (int i = 0; i < 3; ++i)
          by_point[3 * row + i] = ((row == i) - bent[row] * slope[i]) * inverse;
    }
    if (by_terms) {
      const double by_xi = -(alpha * shifted / d2 + 1 - alpha) * d1 * inverse;
      const double by_alpha = -(d2 - shifted) * inverse;
      for (int row = 0; row < 2; ++row) {
        by_terms[2 * row] = bent[row] * by_xi;
        by_terms[2 * row + 1] = bent[row] * by_alpha;
      }
    }
    return true;
  }
};

/// Pixel of a point in the camera's frame: f * bent + c.  `parameters` are fx fy cx cy, then the
/// lens' terms; pixel (0, 0) is the centre of the upper left one.  Derivatives row-major, 2 x 3 and
/// 2 x (4 + kTerms), or null.
template <class Lens>
bool ProjectThrough(const double* parameters, const double* point_in_camera, double* pixel,
                    double* by_point, double* by_parameters) {
  constexpr int kSize = 4 + Lens::kTerms;
  double bent[2], by_terms[2 * Lens::kTerms + 1];
  if (!Lens::Bend(parameters + 4, point_in_camera, bent, by_point,
                  by_parameters ? by_terms : nullptr))
    return false;
  for (int row = 0; row < 2; ++row) {
    const double f = parameters[row];
    pixel[row] = f * bent[row] + parameters[2 + row];
    if (by_point)
      for (int i = 0; i < 3; ++i) by_point[3 * row + i] *= f;
    if (by_parameters) {
      double* out = by_parameters + kSize * row;
      out[0] = row == 0 ? bent[0] : 0;
      out[1] = row == 1 ? bent[1] : 0;
      out[2] = row == 0;
      out[3] = row == 1;
      for (int i = 0; i < Lens::kTerms; ++i) out[4 + i] = f * by_terms[Lens::kTerms * row + i];
    }
  }
  return true;
}

}  // namespace graticule
