// Lists of corners that other calibrators keep: mrcal's .vnl, BabelCalib's .orpc, .dsc and .tp.

#include <map>
#include <set>
#include <utility>

#include "graticule/io/comma_separated.hpp"
#include "graticule/io/detections.hpp"
#include "graticule/io/detections_check.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr int kMostOnBoard = 1 << 16;  // corners
constexpr double kCentimetre = 0.01;   // the unit of .dsc and .tp

int Bounded(TextReader* reader, const char* what, int least, int most) {
  const std::uint64_t number = reader->Integer(what);
  if (number < static_cast<std::uint64_t>(least) || number > static_cast<std::uint64_t>(most))
    reader->Fail("expected " + std::string(what) + " in " + std::to_string(least) + " to " +
                 std::to_string(most) + ", found " + std::to_string(number));
  return static_cast<int>(number);
}

void RefuseCutEnd(std::string_view text, const TextReader& reader) {
  if (text.empty()) reader.FailAt(0, "the file is empty");
  if (text.back() != '\n')
    reader.FailAt(text.size(), "expected the end of the line: the file may be cut short");
}

/// Where the corners of BabelCalib's boards are: by board and number.
using BoardPlaces = std::map<std::pair<int, int>, std::array<double, 3>>;

/// A board's pose: 3 x 4, row by row.
using BoardPoses = std::map<int, std::array<double, 12>>;

BoardPoses ReadBoardPoses(const NamedText& file) {
  BoardPoses poses;
  if (file.name.empty()) return poses;
  const std::string text = CommasAsBlanks(file.text, file.name);
  TextReader reader(text, file.name);
  while (reader.NextWord()) {
    const int board = Bounded(&reader, "the board's number", 0, 1 << 14);
    std::array<double, 12> pose;
    for (double& value : pose) {
      if (!reader.NextWord()) reader.FailAt(text.size(), "expected twelve numbers of a pose");
      value = reader.Double("the board's pose");
    }
    if (!poses.emplace(board, pose).second) reader.Fail("this board's pose is there already");
  }
  return poses;
}

// "0,23,23,7.5" (board, squares across and down, their size in mm), then the family of its tags,
// then the corners "tag,column,row,x,y,z" [cm] in the order of their numbers.
BoardPlaces ReadBoards(const NamedText& file, const BoardPoses& poses) {
  const std::string text = CommasAsBlanks(file.text, file.name);
  TextReader reader(text, file.name);
  RefuseCutEnd(text, reader);
  BoardPlaces places;
  while (reader.NextLine()) {
    const int board = Bounded(&reader, "the board's number", 0, (1 << 14) - 1);
    const int columns = Bounded(&reader, "the number of squares across", 2, 1 << 10);
    const int rows = Bounded(&reader, "the number of squares down", 2, 1 << 10);
    reader.Double("the size of a square");
    if (!reader.NextLine()) reader.FailAt(text.size(), "expected the family of the board's tags");
    reader.Word("the family of the board's tags");
    const int count = (columns - 1) * (rows - 1);
    if (count > kMostOnBoard || places.count({board, 0}))
      reader.Fail("expected a board of at most 65536 corners, once");
    std::array<double, 12> pose = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    if (const auto known = poses.find(board); known != poses.end()) pose = known->second;
    for (int i = 0; i < count; ++i) {
      if (!reader.NextLine())
        reader.FailAt(text.size(),
                      "expected " + std::to_string(count) + " corners, found " + std::to_string(i));
      if (!reader.Accept("-1")) reader.Integer("the tag's id or -1");
      reader.Integer("the corner's column");
      reader.Integer("the corner's row");
      double at[3];
      for (double& value : at) value = reader.Double("the corner's place");
      reader.ExpectEnd();
      std::array<double, 3>& place = places[{board, i}];
      for (std::size_t k = 0; k < 3; ++k) {
        const double* row = pose.data() + 4 * k;
        place[k] = kCentimetre * (row[0] * at[0] + row[1] * at[1] + row[2] * at[2] + row[3]);
      }
    }
  }
  return places;
}

TargetView ReadOrpc(const NamedText& file, const BoardPlaces& boards, ImageSize* camera) {
  const std::string text = CommasAsBlanks(file.text, file.name);
  TextReader reader(text, file.name);
  RefuseCutEnd(text, reader);
  TargetView view;
  std::map<std::string, std::uint64_t, std::less<>> header;
  while (reader.NextLine()) {
    const std::string_view key = reader.Word();
    if (key == "filename:") {
      view.image = reader.Rest();
    } else if (key == "encoding:") {
      if (const std::string_view word = reader.Word("the encoding"); word != "ascii")
        reader.Fail("expected the encoding 'ascii', found " + Quoted(word));
      break;
    } else if (key == "width:" || key == "height:" || key == "num_corners:") {
      header[std::string(key)] =
          static_cast<std::uint64_t>(Bounded(&reader, "this number", 1, 1 << 20));
    } else {
      reader.Fail("expected a line of the header, found " + Quoted(key));
    }
  }
  if (view.image.empty() || header.size() != 3)
    reader.FailAt(0, "expected filename, width, height, num_corners and encoding");
  const ImageSize size{"", static_cast<int>(header["width:"]), static_cast<int>(header["height:"])};
  if (camera->width == 0) *camera = size;
  if (camera->width != size.width || camera->height != size.height)
    reader.FailAt(0, "images of one camera have one size: this is " + SizeText(size) +
                         ", those before " + SizeText(*camera));
  IdsOfView seen;
  while (reader.NextLine()) {
    const int board = Bounded(&reader, "the board's number", 0, (1 << 14) - 1);
    const int number = Bounded(&reader, "the corner's number", 0, kMostOnBoard - 1);
    const auto place = boards.find({board, number});
    if (place == boards.end())
      reader.Fail("board " + std::to_string(board) + " has no corner " + std::to_string(number));
    reader.Integer("the corner's order");
    DetectedCorner corner{board * kMostOnBoard + number, place->second, {}};
    corner.pixel[0] = reader.Double("x of the corner");
    corner.pixel[1] = reader.Double("y of the corner");
    reader.ExpectEnd();
    if (const auto wrong = seen.Add(corner.id)) reader.Fail(*wrong);
    view.corners.push_back(corner);
  }
  if (view.corners.size() != header["num_corners:"])
    reader.FailAt(text.size(), "expected " + std::to_string(header["num_corners:"]) +
                                   " corners, found " + std::to_string(view.corners.size()));
  return view;
}

}  // namespace

Detections ParseBabelcalib(const std::vector<NamedText>& views, const NamedText& board,
                           const NamedText& places) {
  const BoardPlaces boards = ReadBoards(board, ReadBoardPoses(places));
  Detections detections;
  detections.cameras.resize(1);
  for (const NamedText& file : views) {
    detections.views.push_back(ReadOrpc(file, boards, &detections.cameras[0]));
    detections.views.back().exposure = detections.exposures++;
  }
  if (detections.views.empty()) throw Error(board.name + ": there is no view of this board");
  return detections;
}

Detections ParseCornerList(std::string_view text, const std::string& name,
                           const std::string& camera, const CornerListOptions& options) {
  TextReader reader(text, name);
  if (options.columns < 2 || options.rows < 2 || !(options.spacing_m > 0) || options.width < 1 ||
      options.height < 1)
    throw Error(name +
                    ": a list of corners says neither the board's columns, rows and spacing "
                    "nor the images' size: expected them beside it",
                ErrorKind::kUsage);
  RefuseCutEnd(text, reader);
  const int count = options.columns * options.rows;
  Detections detections;
  detections.cameras.push_back({camera, options.width, options.height});

  bool has_weights = false, has_levels = false, is_first = true;
  std::set<std::string, std::less<>> known;  // images
  std::string image;
  std::vector<DetectedCorner> corners;
  int lines = 0;  // of the image
  bool is_missing = false;
  const auto finish = [&](std::size_t offset) {
    // An image in which nothing was found has one line of dashes.
    if (lines == 0 || (lines == 1 && is_missing)) return;
    if (lines != count)
      reader.FailAt(offset, "expected " + std::to_string(count) + " corners of " + Quoted(image) +
                                ", found " + std::to_string(lines));
    detections.views.push_back({image, 0, detections.exposures++, std::move(corners)});
  };
  while (reader.NextLine()) {
    const std::string_view first = reader.Word();
    if (first[0] == '#') {
      // The last header before the corners names the columns.
      if (is_first) {
        const std::string_view columns = reader.Rest();
        has_weights = columns.find("weight") != std::string_view::npos;
        has_levels = columns.find("level") != std::string_view::npos;
      }
      continue;
    }
    is_first = false;
    if (first != image) {
      finish(reader.LineOffset());
      image = first;
      if (!known.insert(image).second)
        reader.Fail("corners of " + Quoted(image) + " are there already; expected those of one " +
                    "image one after the other");
      lines = 0;
      corners.clear();
    }
    DetectedCorner corner;
    corner.id = lines++;
    corner.in_target = {options.spacing_m * (corner.id % options.columns),
                        options.spacing_m * (corner.id / options.columns), 0};
    is_missing = reader.Accept("-");
    if (is_missing) {
      while (reader.Accept("-")) continue;
    } else {
      corner.pixel[0] = reader.Double("x of the corner");
      corner.pixel[1] = reader.Double("y of the corner");
      bool counts = true;
      if ((has_levels || has_weights) && reader.Accept("-")) {
        counts = false;
      } else if (has_levels || has_weights) {
        const double value = reader.Double(has_weights ? "the weight" : "the level");
        counts = has_weights ? value > 0 : value >= 0;
      }
      if (counts) corners.push_back(corner);
    }
    reader.ExpectEnd();
  }
  finish(text.size());
  if (detections.views.empty()) reader.FailAt(0, "there is no view");
  return detections;
}

}  // namespace graticule
