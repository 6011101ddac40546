#include "graticule/problems/calibration/print_target.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "graticule/io/file.hpp"
#include "graticule/io/svg.hpp"
#include "graticule/io/text.hpp"
#include "graticule/problems/calibration/marker_codes.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr double kMargin_mm = 5;   // that printers leave white
constexpr double kFooter_mm = 12;  // text and the bar

[[noreturn]] void Refuse(const std::string& why) { throw Error(why, ErrorKind::kUsage); }

std::string Millimetres(double value) {
  std::string text = SvgNumber(value);
  return text + " mm";
}

// What of a page a target may have.
PaperSize Room(const PaperSize& paper) {
  return {paper.width_mm - 2 * kMargin_mm, paper.height_mm - 2 * kMargin_mm - kFooter_mm};
}

PaperSize SizeOf(const Target& target) {
  const std::array<double, 4> box = ExtentOf(target);
  return {1e3 * (box[2] - box[0]), 1e3 * (box[3] - box[1])};
}

bool Fits(const Target& target, const PaperSize& paper) {
  const PaperSize size = SizeOf(target), room = Room(paper);
  return size.width_mm <= room.width_mm + 1e-9 && size.height_mm <= room.height_mm + 1e-9;
}

double SuitablePitch(TargetKind kind, const PaperSize& paper) {
  constexpr double kA3Width = 420;
  const double scale = std::max(paper.width_mm, paper.height_mm) / kA3Width;
  double at_a3 = 38.1;
  if (kind == TargetKind::kAprilGrid) at_a3 = 40;
  if (kind == TargetKind::kChessboard) at_a3 = 30;
  if (kind == TargetKind::kCharuco) at_a3 = 30;
  const double pitch = at_a3 * scale;
  // Round numbers, but for AprilCal's own.
  return std::abs(scale - 1) < 1e-6 ? at_a3 : std::max(1.0, std::floor(pitch));
}

// Adds columns or rows as long as they fit the page and the family.
void Extend(const PaperSize& paper, int* count, int most, Target* target) {
  const int given = *count;
  for (*count = given + 1; *count <= most; ++*count) {
    bool fits = Fits(*target, paper);
    try {
      CheckTarget(*target);
    } catch (const Error&) {
      fits = false;
    }
    if (!fits) break;
  }
  --*count;
}

}  // namespace

PaperSize PaperSizeOf(std::string_view word) {
  const struct {
    const char* name;
    PaperSize size;
  } known[] = {{"A0", {1189, 841}},        {"A1", {841, 594}},        {"A2", {594, 420}},
               {"A3", {420, 297}},         {"A4", {297, 210}},        {"A5", {210, 148}},
               {"letter", {279.4, 215.9}}, {"legal", {355.6, 215.9}}, {"tabloid", {431.8, 279.4}}};
  for (const auto& paper : known)
    if (word == paper.name) return paper.size;
  const std::size_t by = word.find('x');
  PaperSize size;
  if (by != std::string_view::npos) {
    const auto read = [](std::string_view part, double* value) {
      const char* last = part.data() + part.size();
      const auto [stop, problem] = std::from_chars(part.data(), last, *value);
      return problem == std::errc() && stop == last;
    };
    if (read(word.substr(0, by), &size.width_mm) && read(word.substr(by + 1), &size.height_mm) &&
        size.width_mm >= 40 && size.height_mm >= 40 && size.width_mm <= 10000 &&
        size.height_mm <= 10000)
      return size;
  }
  Refuse("there is no paper " + Quoted(word) +
         "; expected A0 to A5, letter, legal, tabloid or WIDTHxHEIGHT in mm, 40 to 10000");
}

Target FitTarget(const TargetRequest& request) {
  Target target;
  target.kind = request.kind;
  target.family = request.family;
  if (target.family.empty())
    target.family = target.kind == TargetKind::kCharuco ? "DICT_4X4_250" : "tag36h11";
  if (target.kind == TargetKind::kChessboard) target.family.clear();
  target.border_cells = target.kind == TargetKind::kAprilGrid ? 2 : 1;
  const double pitch_mm =
      request.pitch_mm > 0 ? request.pitch_mm : SuitablePitch(target.kind, request.paper);
  target.pitch_m = pitch_mm / 1e3;
  target.marker_m = target.kind == TargetKind::kCharuco ? 0.75 * target.pitch_m : 0;
  const bool is_board =
      target.kind == TargetKind::kChessboard || target.kind == TargetKind::kCharuco;
  const int least = is_board ? 3 : 1;
  target.columns = request.columns > 0 ? request.columns : least;
  target.rows = request.rows > 0 ? request.rows : least;
  if (target.kind == TargetKind::kTagMosaic) {
    // AprilCal's numbers where the family has enough of them, else without gaps.
    const MarkerFamily family = MarkerFamilyOf(target.family);
    const int tags_down = static_cast<int>(Room(request.paper).height_mm / pitch_mm) + 1;
    const int rows = request.rows > 0 ? request.rows : tags_down;
    if (target.stride * rows > family.markers) {
      const int tags_across = static_cast<int>(Room(request.paper).width_mm / pitch_mm) + 1;
      target.stride = request.columns > 0 ? request.columns : std::min(tags_across, family.markers);
    }
  }
  CheckTarget(target);
  if (!Fits(target, request.paper)) {
    const PaperSize size = SizeOf(target), room = Room(request.paper);
    Refuse("a " + Described(target) + " needs " + Millimetres(size.width_mm) + " x " +
           Millimetres(size.height_mm) + ", the page has " + Millimetres(room.width_mm) + " x " +
           Millimetres(room.height_mm) + " beside margins and text");
  }
  const int most_columns = target.kind == TargetKind::kTagMosaic ? target.stride : 200;
  if (request.columns <= 0) Extend(request.paper, &target.columns, most_columns, &target);
  if (request.rows <= 0) Extend(request.paper, &target.rows, 200, &target);
  // One odd, one even: a board that cannot be taken for itself upside down.
  if (target.kind == TargetKind::kChessboard && request.columns <= 0 && request.rows <= 0 &&
      (target.columns + target.rows) % 2 == 0 && target.rows > 2)
    --target.rows;
  return target;
}

std::string PrintTargetSvg(const Target& target, const PaperSize& paper) {
  CheckTarget(target);
  if (!Fits(target, paper))
    Refuse("the " + Described(target) + " does not fit a page of " + Millimetres(paper.width_mm) +
           " x " + Millimetres(paper.height_mm));
  const std::array<double, 4> box = ExtentOf(target);
  const PaperSize size = SizeOf(target), room = Room(paper);
  const double left = kMargin_mm + (room.width_mm - size.width_mm) / 2;
  const double top = kMargin_mm + (room.height_mm - size.height_mm) / 2;

  Svg svg(paper.width_mm, paper.height_mm, Described(target), "mm");
  svg.Rect(0, 0, paper.width_mm, paper.height_mm, {{"fill", "#fff"}});
  // One path: squares that touch leave no seams where edges are smoothed.
  PathData black(3);
  for (const TargetSquare& square : BlackOf(target)) {
    const double x = left + 1e3 * (square.x - box[0]);
    const double y = HasYUp(target) ? top + 1e3 * (box[3] - square.y - square.height)
                                    : top + 1e3 * (square.y - box[1]);
    const double width = 1e3 * square.width, height = 1e3 * square.height;
    black.MoveTo(x, y);
    black.LineTo(x + width, y);
    black.LineTo(x + width, y + height);
    black.LineTo(x, y + height);
    black.Close();
  }
  svg.Path(black, {{"fill", "#000"}});

  const double bar = paper.width_mm >= 150 ? 100 : 25;
  const double line = paper.height_mm - kMargin_mm - 3;
  const double x0 = paper.width_mm - kMargin_mm - bar - 2, x1 = x0 + bar;
  PathData ruler(3);
  ruler.Segment(x0, line, x1, line);
  for (int i = 0; i <= 10; ++i) {
    const double x = x0 + bar * i / 10;
    ruler.Segment(x, line, x, line - (i % 5 == 0 ? 3 : 1.5));
  }
  svg.Path(ruler, {{"stroke", "#000"}, {"stroke-width", "0.25"}, {"fill", "none"}});
  const double font = paper.width_mm >= 250 ? 3.2 : 2.2;
  svg.Text(x0, line - 4, "printed at 100 % this is " + Millimetres(bar),
           {{"font-size", SvgNumber(font)}, {"fill", "#000"}});
  svg.Text(kMargin_mm + 2, line - 4, Described(target),
           {{"font-size", SvgNumber(font)}, {"fill", "#000"}});
  svg.Text(kMargin_mm + 2, line, "graticule calibrate target; do not scale, keep it flat",
           {{"font-size", SvgNumber(font)}, {"fill", "#000"}});
  return svg.Finish();
}

std::string PrintTarget(const std::string& path, const Target& target, const PaperSize& paper) {
  const std::string svg = PrintTargetSvg(target, paper);
  std::filesystem::path description(path);
  const std::string ending = description.extension().string();
  if (ending == ".svg") {
    WriteFile(path, svg);
  } else if (ending == ".pdf") {
    WriteFile(path, PdfFromSvg(svg, paper.width_mm, paper.height_mm));
  } else if (ending == ".png") {
    constexpr double kDotsPerMm = 300 / 25.4;
    const double most = 20000 / std::max(paper.width_mm, paper.height_mm);
    WriteFile(path, PngFromSvg(svg, static_cast<int>(
                                        std::lround(paper.width_mm * std::min(kDotsPerMm, most)))));
  } else {
    Refuse(path + ": expected a name that ends in .pdf, .svg or .png");
  }
  description.replace_extension(".yaml");
  WriteTarget(description.string(), target);
  return description.string();
}

}  // namespace graticule
