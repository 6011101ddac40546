#pragma once

// Internal to camera_file.cpp: one pair of functions a format, and what they share.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/camera_file.hpp"
#include "graticule/io/camera_pose.hpp"
#include "graticule/io/document.hpp"

namespace graticule {

constexpr long kMostPixelsASide = 1 << 20;

/// The terms of a camera in the order of OpenCV: k1 k2 p1 p2 k3 k4 k5 k6; none if it is no
/// Brown-Conrady model.
std::optional<std::array<double, 8>> BrownTerms(const CameraIntrinsics& camera);
/// k1 to k4 of an angular polynomial; none if it is none, or has more that are not zero.
std::optional<std::array<double, 4>> AngularTerms(const CameraIntrinsics& camera);
/// alpha of the unified model, and of those that contain it where they are it.
std::optional<double> UnifiedAlpha(const CameraIntrinsics& camera);
/// alpha beta
std::optional<std::array<double, 2>> ExtendedUnifiedTerms(const CameraIntrinsics& camera);
/// xi alpha
std::optional<std::array<double, 2>> DoubleSphereTerms(const CameraIntrinsics& camera);

/// How many of the terms count, as OpenCV writes them: 0, 4, 5 or 8.
std::size_t BrownCount(const std::array<double, 8>& terms);
/// pinhole, brown4, brown5, brown8 by the number of terms.  More than 8 have to be zero.  Fails at
/// `place`.
void SetBrown(const std::vector<double>& terms, const DocumentNode& place,
              CameraIntrinsics* camera);

/// The unified model in the terms of Mei and Rives, and of OpenCV's omnidir: x / (z + xi d) at
/// focal length gamma.  Ours is x / (alpha d + (1 - alpha) z) at f; with both divided by (1 -
/// alpha): xi = alpha / (1 - alpha), gamma = f / (1 - alpha) = f (1 + xi).
CameraIntrinsics FromOmni(double xi, double fx, double fy, double cx, double cy);
struct Omni {
  double xi, fx, fy;
};
Omni ToOmni(const CameraIntrinsics& camera, double alpha);

/// Of a matrix [fx 0 cx; 0 fy cy; 0 0 1], row by row.
std::array<double, 4> FocalAndCentre(const std::vector<double>& matrix, const DocumentNode& place);

/// A matrix {rows, cols, data} of OpenCV and ROS.
std::vector<double> ReadMatrix(const DocumentNode& node, std::size_t rows, std::size_t columns);
/// One with any number of entries.
std::vector<double> ReadMatrix(const DocumentNode& node);

/// "[1, 2.5]"
std::string NumberList(const double* values, std::size_t count);
template <class Values>
std::string NumberList(const Values& values) {
  return NumberList(values.data(), values.size());
}

CameraRig ReadOwnCameras(const DocumentNode& root);
std::string FormatOwnCameras(const CameraRig& rig);
CameraRig ReadOpenCvCameras(const DocumentNode& root);
std::string FormatOpenCvCameras(const CameraRig& rig);
CameraRig ReadRosCamera(const DocumentNode& root);
std::string FormatRosCamera(const CameraRig& rig);
CameraRig ReadKalibrCameras(const DocumentNode& root);
std::string FormatKalibrCameras(const CameraRig& rig);
CameraRig ReadMrcalCamera(const DocumentNode& root);
std::string FormatMrcalCamera(const CameraRig& rig);

}  // namespace graticule
