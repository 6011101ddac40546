#pragma once

#include <string>
#include <string_view>

#include "graticule/io/cloud.hpp"

namespace graticule {

/// Reads a cloud by its name's ending (`.gz` behind it is unpacked): `.pcd`, `.ply`, `.bin` (KITTI;
/// organised as OrganiseSpinning does), `.csv` (a sweep of planar scans, io/sweep.hpp).  Throws
/// Error (kUsage) for another ending, Error "path: ..." where there is not one return, and those
/// of the parsers below.
PointCloud ReadCloud(const std::string& path);

/// Writes `.pcd` or `.ply`, in one step (io/file.hpp).  Throws Error (kUsage) for another ending or
/// lists of unequal lengths, kOther for a full disk.
void WriteCloud(const std::string& path, const PointCloud& cloud);

/// PCD 0.6 and 0.7 of PCL: ascii, binary, binary_compressed; fields in any order and of any size.
///
/// Read are x, y, z [m], rgb or rgba (packed, as float or whole number), or r, g, b, intensity (or
/// reflectance, reflectivity, remission), label; others are passed over, and so is VIEWPOINT.  A
/// coordinate that is not finite makes the point kNoReturn; a label below 0 is none.  Bytes behind
/// the points are passed over: PCL leaves some.
///
/// Throws Error "name:line:column: ..." for the header and ascii points, "name: at byte N: ..." for
/// binary ones: cut short, sizes that the file does not hold, counts that disagree, a coordinate
/// beyond 1e9 m.
PointCloud ParsePcd(std::string_view bytes, const std::string& name);

/// PLY 1.0: ascii, binary_little_endian, binary_big_endian.  The element `vertex` with the
/// properties of ParsePcd (colours also as red, green, blue: bytes, 16 bits, or floats from 0 to
/// 1); other elements are passed over.  `obj_info num_cols` and `num_rows` organise it.  Errors as
/// ParsePcd's.
PointCloud ParsePly(std::string_view bytes, const std::string& name);

/// KITTI's velodyne/*.bin: x y z reflectance, float32 little endian, in the order of the file, one
/// row.  Throws Error "name: at byte N: ...".
PointCloud ParseKittiScan(std::string_view bytes, const std::string& name);

/// Binary; fields x y z [rgb] [intensity] [label], as PCL's own types have them.
std::string FormatPcd(const PointCloud& cloud);
/// Binary, little endian; properties x y z [red green blue] [intensity] [label].
std::string FormatPly(const PointCloud& cloud);

struct SpinningOptions {
  std::size_t beams = 64;  ///< at most so many rows (2 more where the first turn is broken)
};

/// The scan of a rotating LIDAR, a beam a row (the highest first, where the file has it so) and the
/// azimuth a column (clockwise from straight behind, as a picture has it).
///
/// Points that come beam by beam, as KITTI's do, are told apart where the azimuth wraps; others are
/// sorted into `beams` rows of equal steps of elevation.  No return of a beam is lost: where two
/// want one column, the second goes one further.  Points without a return are dropped; free
/// columns are kNoReturn.  O(n log n).
PointCloud OrganiseSpinning(const PointCloud& cloud, const SpinningOptions& options = {});

}  // namespace graticule
