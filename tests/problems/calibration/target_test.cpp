#include "graticule/problems/calibration/target.hpp"

#include <gtest/gtest.h>

#include <bitset>
#include <cmath>
#include <map>
#include <set>

#include "../../solver/expect_error.hpp"
#include "graticule/problems/calibration/marker_codes.hpp"
#include "graticule/problems/calibration/print_target.hpp"
#include "targets.hpp"

namespace graticule {
namespace {

using testing::ExpectError;

std::vector<std::uint8_t> Turned(const std::vector<std::uint8_t>& code, int cells) {
  std::vector<std::uint8_t> turned(code.size());
  for (int y = 0; y < cells; ++y)
    for (int x = 0; x < cells; ++x)
      turned[static_cast<std::size_t>(x * cells + cells - 1 - y)] =
          code[static_cast<std::size_t>(y * cells + x)];
  return turned;
}

int Distance(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  int distance = 0;
  for (std::size_t i = 0; i < a.size(); ++i) distance += a[i] != b[i];
  return distance;
}

TEST(MarkerFamily, HasCodesThatStayApartHoweverTheyAreTurned) {
  for (const std::string& name : MarkerFamilyNames()) {
    const MarkerFamily family = MarkerFamilyOf(name);
    EXPECT_EQ(family.codes.size(), static_cast<std::size_t>(family.markers)) << name;
    const std::size_t most = std::min<std::size_t>(family.codes.size(), 100);
    int least = 1000;
    for (std::size_t i = 0; i < most; ++i) {
      std::vector<std::uint8_t> turned = family.codes[i];
      for (int turn = 0; turn < 4; ++turn) {
        for (std::size_t k = 0; k < i; ++k)
          least = std::min(least, Distance(turned, family.codes[k]));
        turned = Turned(turned, family.cells);
      }
    }
    EXPECT_GT(least, 2 * family.correctable) << name;
  }
  EXPECT_EQ(MarkerFamilyOf("tag36h11").markers, 587);
  ExpectError(ErrorKind::kUsage,
              {"there is no family of markers 'tag99'; expected one of tag36h11"},
              [] { MarkerFamilyOf("tag99"); });
}

TEST(Target, ComesBackFromItsDescription) {
  for (const Target& target : test::OneOfEachKind()) {
    const std::string text = FormatTarget(target);
    const Target again = ParseTarget(text, "a.yaml");
    EXPECT_EQ(FormatTarget(again), text);
    EXPECT_EQ(again.pitch_m, target.pitch_m);
    EXPECT_EQ(Described(again), Described(target));
    for (std::size_t n = 0; n + 1 < text.size(); ++n)
      EXPECT_THROW(ParseTarget(text.substr(0, n), "a.yaml"), Error) << text.substr(0, n);
  }
}

TEST(Target, ReadsKalibrsDescription) {
  const Target grid = ParseTarget(
      "target_type: 'aprilgrid' #gridtype\ntagCols: 6  #number of apriltags\ntagRows: 5\n"
      "tagSize: 0.088\ntagSpacing: 0.3\ncodeOffset: 0\n",
      "a.yaml");
  EXPECT_EQ(grid.kind, TargetKind::kAprilGrid);
  EXPECT_EQ(grid.rows, 5);
  EXPECT_EQ(grid.border_cells, 2);
  const std::vector<TargetCorner> corners = CornersOf(grid);
  ASSERT_EQ(corners.size(), 4u * 30);
  // As its own corners are counted: from the lower left, up.
  EXPECT_EQ(corners[5].id, 5);
  EXPECT_NEAR(corners[5].in_target[0], 0.088 * 1.3 + 0.088, 1e-12);
  EXPECT_NEAR(corners[5].in_target[1], 0, 1e-12);
  EXPECT_NEAR(corners[4 * 6 + 3].in_target[1], 0.088 * 1.3 + 0.088, 1e-12);
  const Target board = ParseTarget(
      "target_type: checkerboard\ntargetCols: 6\ntargetRows: 7\nrowSpacingMeters: 0.06\n"
      "colSpacingMeters: 0.06\n",
      "a.yaml");
  EXPECT_EQ(board.kind, TargetKind::kChessboard);
  EXPECT_EQ(board.columns, 6);
}

TEST(Target, SaysWhatIsWrongWithADescription) {
  const std::string grid = FormatTarget(test::OneOfEachKind()[1]);
  const struct {
    const char *from, *to, *message;
  } cases[] = {
      {"columns: 4", "columns: 0", "a.yaml:4:10: expected a whole number in 1 to 10000, found '0'"},
      {"kind: aprilgrid", "kind: circles", "expected mosaic, aprilgrid, charuco or chessboard"},
      {"family: tag36h11", "family: tag36", "a.yaml: there is no family of markers 'tag36'"},
      {"pitch_m: 0.03", "pitch_m: -1", "a.yaml: target: expected a size above zero"},
      {"spacing: 0.3", "spacing: nan", "expected a finite number"},
      {"first_id: 0", "first_id: 580", "tag36h11 has 587 markers, the last here would be 591"},
  };
  for (const auto& c : cases) {
    std::string text = grid;
    const std::size_t at = text.find(c.from);
    ASSERT_NE(at, std::string::npos) << c.from;
    text.replace(at, std::string(c.from).size(), c.to);
    try {
      ParseTarget(text, "a.yaml");
      ADD_FAILURE() << c.to;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(c.message), std::string::npos) << error.what();
    }
  }
  ExpectError(ErrorKind::kInput, {"a.yaml: expected a target's description"},
              [] { ParseTarget("a: 1\n", "a.yaml"); });
}

TEST(Target, HasEveryCornerWhereItsSquaresMeet) {
  for (const Target& target : test::OneOfEachKind()) {
    const std::vector<TargetSquare> black = BlackOf(target);
    const auto is_black = [&](double x, double y) {
      for (const TargetSquare& s : black)
        if (x > s.x && y > s.y && x < s.x + s.width && y < s.y + s.height) return true;
      return false;
    };
    std::set<int> ids;
    for (const TargetCorner& corner : CornersOf(target)) {
      EXPECT_TRUE(ids.insert(corner.id).second);
      const double x = corner.in_target[0], y = corner.in_target[1], d = target.pitch_m / 50;
      const int count = is_black(x + d, y + d) + is_black(x - d, y - d) + is_black(x + d, y - d) +
                        is_black(x - d, y + d);
      EXPECT_EQ(count, corner.saddle ? 2 : 1) << Described(target) << " " << corner.id;
      if (corner.saddle) {
        EXPECT_EQ(is_black(x + d, y + d), corner.saddle > 0);
      }
    }
  }
}

TEST(Target, FillsThePageThatItIsFor) {
  TargetRequest request;
  request.paper = PaperSizeOf("A3");
  const Target mosaic = FitTarget(request);
  EXPECT_NEAR(mosaic.pitch_m, 0.0381, 1e-12);  // AprilCal's
  EXPECT_EQ(mosaic.stride, 24);
  EXPECT_EQ(mosaic.columns, 10);
  EXPECT_EQ(mosaic.rows, 7);
  for (const TargetKind kind : {TargetKind::kAprilGrid, TargetKind::kCharuco,
                                TargetKind::kChessboard, TargetKind::kTagMosaic})
    for (const char* paper : {"A4", "letter", "A0", "100x80"}) {
      request.kind = kind;
      request.paper = PaperSizeOf(paper);
      const Target target = FitTarget(request);
      EXPECT_GE(target.columns * target.rows, 6) << paper << " " << Described(target);
      EXPECT_NO_THROW(PrintTargetSvg(target, request.paper));
    }
  request.pitch_mm = 300;
  request.paper = PaperSizeOf("A4");
  ExpectError(ErrorKind::kUsage, {"needs", "the page has"}, [&] { FitTarget(request); });
  ExpectError(ErrorKind::kUsage, {"there is no paper 'A9'"}, [] { PaperSizeOf("A9"); });
  ExpectError(ErrorKind::kUsage, {"there is no paper '1e9x3'"}, [] { PaperSizeOf("1e9x3"); });
}

}  // namespace
}  // namespace graticule
