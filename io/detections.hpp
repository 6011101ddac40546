#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace graticule {

/// A corner of a target, seen in an image.
struct DetectedCorner {
  int id = 0;                            ///< the same corner has the same id in every view
  std::array<double, 3> in_target = {};  ///< m
  std::array<double, 2> pixel = {};      ///< (0, 0) is the centre of the upper left one
};

/// What one camera saw of the target at one time.
struct TargetView {
  std::string image;         ///< its name, for messages
  std::size_t camera = 0;    ///< into Detections::cameras
  std::size_t exposure = 0;  ///< views of one exposure saw the target at one place
  std::vector<DetectedCorner> corners;
};

/// Size of a camera's images.
struct ImageSize {
  std::string camera;         ///< its name, "cam0"
  int width = 0, height = 0;  ///< px
};

/// Everything that calibration looks at: the corners of one rigid target, seen by one or several
/// cameras.
struct Detections {
  std::vector<ImageSize> cameras;
  std::vector<TargetView> views;
  std::size_t exposures = 0;
};

/// What a list of corners does not say itself: mrcal's `.vnl`.
struct CornerListOptions {
  int columns = 0, rows = 0;  ///< of the chessboard's inner corners, as mrcal's --object-width-n
  double spacing_m = 0;       ///< between neighbouring corners
  int width = 0, height = 0;  ///< of the images [px]
};

/// Reads recorded detections.  The format is told by the names' endings:
///
/// - `.json`, one a camera of a rig: {name, size: [w, h], views: [{name, ids, obj, img, w?}]}, or
///   several cameras in one (docs/formats.md).  An id is a whole number, or [board, number], which
///   becomes board * 65536 + number.  A corner whose `w` is zero or less was set aside by who
///   recorded it, and is left out.
/// - `.vnl`, one a camera: mrcal's `--corners-cache`; needs `corner_list`.
/// - `.orpc`, one a view of one camera, with the board's `.dsc` (and `.tp`) among the paths or,
///   one of it, in the folder of the first or the one above: BabelCalib.
///
/// Views of several cameras that were taken at one time are one exposure: they have the same name
/// (without its ending), or where no name is the same, the same last number (left01, right01).
///
/// Throws Error "name: path in the document: ..." or "name:line:column: ...": numbers that are not
/// finite, lists that differ in length, no view, an id twice in a view or with two places on the
/// target, images of several sizes, a file that is cut short.
Detections ReadDetections(const std::vector<std::string>& paths,
                          const CornerListOptions& corner_list = {});

/// One JSON document.
Detections ParseDetections(std::string_view text, const std::string& name);
/// One `.vnl`: a camera named `camera`.
Detections ParseCornerList(std::string_view text, const std::string& name,
                           const std::string& camera, const CornerListOptions& options);

/// A text and what messages call it.
struct NamedText {
  std::string name, text;
};
/// BabelCalib's files of one camera; `places` (.tp) may be empty, where there is one board.
Detections ParseBabelcalib(const std::vector<NamedText>& views, const NamedText& board,
                           const NamedText& places);

/// Puts cameras of one rig together: matches their exposures, as ReadDetections says.  Throws
/// Error: a camera's name twice, an id with two places.  `names` are the files', for messages.
Detections CombineCameras(std::vector<Detections> parts, const std::vector<std::string>& names);

/// JSON that ParseDetections reads back to the last bit.
std::string FormatDetections(const Detections& detections);
void WriteDetections(const std::string& path, const Detections& detections);

}  // namespace graticule
