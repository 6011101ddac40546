#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace graticule {

/// A point that a LIDAR measured and a camera saw.
struct Correspondence {
  std::array<double, 3> in_lidar = {};  ///< m
  std::array<double, 2> pixel = {};     ///< (0, 0) is the centre of the upper left pixel
  std::string name;                     ///< "7" (its number in the file) where it has none
};

/// Reads lines `x,y,z,u,v` or `x,y,z,u,v,name` (m, px), separated by commas or blanks; a line that
/// begins with `x` names the columns, `#` begins a comment.  Throws Error "name:line:column: ...":
/// not a finite number, a name that is there twice, a point beyond 1e6 m or a pixel beyond 1e6, no
/// line at all, a last line that is cut short.
std::vector<Correspondence> ParseCorrespondences(std::string_view text, const std::string& name);
std::vector<Correspondence> ReadCorrespondences(const std::string& path);

/// The same file again, to the bit.
std::string FormatCorrespondences(const std::vector<Correspondence>& points);

/// The plane of a board, as a LIDAR measured it: normal . p = offset.
struct MeasuredPlane {
  std::string image;                  ///< of the view of the board that it belongs to
  std::array<double, 3> normal = {};  ///< unit, in the LIDAR's frame
  double offset_m = 0;
};

/// Reads lines `image,nx,ny,nz,offset`, as above; a line that begins with `image` names the
/// columns.
std::vector<MeasuredPlane> ParsePlanes(std::string_view text, const std::string& name);

}  // namespace graticule
