#include "graticule/io/calibration_report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "graticule/io/contours.hpp"
#include "graticule/io/image_panel.hpp"
#include "graticule/io/svg.hpp"
#include "markup.hpp"
#include "png.hpp"

namespace graticule {
namespace {

bool Has(const std::string& text, const std::string& what) {
  return text.find(what) != std::string::npos;
}

// Nothing that is not a number where one belongs.
void ExpectSound(const std::string& text, const std::string& what) {
  EXPECT_EQ(test::TagFault(text), "") << what;
  for (const char* number : {"nan", "inf\"", ">inf", "-inf"})
    EXPECT_FALSE(Has(text, number)) << what << ": " << number;
}

// A bowl of 0 px in the middle of 640 x 480 pixels, 2 px at (0, 0).
ErrorMap Bowl() {
  ErrorMap map;
  map.title = "Bowl";
  map.field = EmptyField(641, 481, 65);
  for (std::size_t r = 0; r < map.field.rows; ++r)
    for (std::size_t c = 0; c < map.field.columns; ++c) {
      const ImagePoint at = map.field.At(c, r);
      map.field.values.push_back(2 * std::hypot(at.x - 320, at.y - 240) / 400);
    }
  return map;
}

double AreaOf(const FieldRegion& region) {
  double area = 0;
  for (const auto& outline : region.outlines)
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const ImagePoint &a = outline[i].at, &b = outline[(i + 1) % outline.size()].at;
      area += (a.x * b.y - b.x * a.y) / 2;
    }
  return std::fabs(area);
}

TEST(Contours, EncloseWhatIsAbove) {
  const ErrorMap map = Bowl();
  // Below 1 px: a disc of 200 px.
  const FieldRegion above = RegionAbove(map.field, 1, false);
  EXPECT_NEAR(AreaOf(above), 641 * 481 - M_PI * 200 * 200, 300);
  const FieldRegion all = RegionAbove(map.field, -1, false);
  EXPECT_NEAR(AreaOf(all), 641 * 481, 2);  // but for half a pixel at the corners
  ASSERT_EQ(all.outlines.size(), 1u);
  for (const auto& point : all.outlines[0]) EXPECT_TRUE(point.border);
  EXPECT_TRUE(RegionAbove(map.field, 3, false).outlines.empty());
}

TEST(Contours, StopAtValuesThatAreMissing) {
  ErrorMap map = Bowl();
  for (std::size_t i = 0; i < map.field.values.size(); ++i)
    if (i % map.field.columns < 32) map.field.values[i] = kNotKnown;  // left of x = 320
  const FieldRegion right = RegionAbove(map.field, -1, false);
  // But for triangles of 5 x 0.5 pixels where the missing values meet the image's edge.
  EXPECT_NEAR(AreaOf(right), (640.5 - 315) * 481, 3);
}

TEST(Contours, CrossSaddles) {
  ImageField field;
  field.width = field.height = 3;
  field.columns = field.rows = 2;
  field.values = {1, 0, 0, 1};
  const FieldRegion region = RegionAbove(field, 0.5, false);
  EXPECT_EQ(region.outlines.size(), 2u);
}

TEST(Contours, HaveRoundLevels) {
  const ContourLevels levels = ChooseLevels(Bowl().field);
  EXPECT_TRUE(levels.logarithmic);
  ASSERT_FALSE(levels.values.empty());
  EXPECT_LE(levels.values.size(), 8u);
  EXPECT_EQ(levels.labels.back(), "1");
  ImageField flat = EmptyField(10, 10, 2);
  flat.values.assign(4, 0.25);
  EXPECT_TRUE(ChooseLevels(flat).values.empty());
  flat.values = {-0.3, 0.1, 0.2, 0.4};
  const ContourLevels even = ChooseLevels(flat);
  EXPECT_FALSE(even.logarithmic);
  EXPECT_EQ(even.labels.front(), "-0.2");
}

TEST(CalibrationPictures, MarkTheLargestErrorAndWhatWasAskedFor) {
  ErrorMap map = Bowl();
  map.limit_px = 1;
  map.mean_px = 0.77;
  const std::string svg = DrawErrorMap(map);
  ExpectSound(svg, "map");
  EXPECT_TRUE(Has(svg, "max 2 px at (0, 0)"));
  EXPECT_TRUE(Has(svg, "mean 0.77 px"));
  EXPECT_TRUE(Has(svg, "bold blue: 1 px"));
  EXPECT_FALSE(Has(svg, "hatched"));
  EXPECT_FALSE(Has(svg, "grey: no ray"));
  EXPECT_GT(test::ReadPng(PngFromSvg(svg, 600)).Colours(), 20u);
  map.seen.assign(map.field.values.size(), 1);
  for (std::size_t i = 0; i < 200; ++i) map.seen[i] = 0;
  map.field.values.back() = kNotKnown;
  const std::string hatched = DrawErrorMap(map);
  ExpectSound(hatched, "hatched");
  EXPECT_TRUE(Has(hatched, "hatched: no corner was seen"));
  EXPECT_TRUE(Has(hatched, "grey: no ray"));
  EXPECT_EQ(hatched, DrawErrorMap(map));
}

TEST(CalibrationPictures, SayHowMuchResidualsAreExaggerated) {
  ResidualPicture picture;
  picture.width = 640;
  picture.height = 480;
  for (int i = 0; i < 100; ++i)
    picture.corners.push_back({0, i, {6.0 * i, 4.0 * i}, {i % 2 ? 0.1 : -0.1, 0}, false});
  picture.corners.push_back({0, 100, {300, 100}, {17, 3}, true});
  picture.corners.push_back({0, 101, {300, 200}, {kNotKnown, 0}, true});
  const std::string svg = DrawResiduals(picture);
  ExpectSound(svg, "residuals");
  // 736 / 30 pixels for 0.1 px of an image drawn at 1.15 pixels a pixel is 213: 200 is the round
  // number below.
  EXPECT_TRUE(Has(svg, "0.1 px (drawn 200 times as long)")) << svg.substr(svg.size() - 800);
  EXPECT_TRUE(Has(svg, "100 corners"));
  EXPECT_TRUE(Has(svg, "2 were set aside"));
  picture.colours = ResidualColours::kByView;
  ExpectSound(DrawResiduals(picture), "by view");
  for (int i = 0; i < 12000; ++i) picture.corners.push_back({0, i, {1, 1}, {.1, .1}, false});
  EXPECT_TRUE(Has(DrawResiduals(picture), "one of 3 is shown"));
}

TEST(CalibrationPictures, CompareResidualsWithAGaussian) {
  // Every length as often as a Gaussian has it: sums of twelve even steps, centred.
  std::vector<CornerResidual> corners;
  std::uint32_t state = 7;
  const auto gaussian = [&] {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += (state = state * 1664525u + 1013904223u) / 4294967296.0;
    return sum;
  };
  for (int i = 0; i < 4000; ++i) corners.push_back({0, i, {0, 0}, {gaussian(), gaussian()}, false});
  const std::string svg = DrawResidualHistogram(corners, 1);
  ExpectSound(svg, "histogram");
  EXPECT_TRUE(Has(svg, "8,000 numbers"));
  EXPECT_TRUE(Has(svg, "Gaussian of 1 px"));
  // Of sums of twelve: 3 - 1.2 / 12, with a standard error of sqrt(24 / 8000).
  const std::size_t kurtosis = svg.find("kurtosis ");
  ASSERT_NE(kurtosis, std::string::npos);
  EXPECT_NEAR(std::stod(svg.substr(kurtosis + 9)), 2.9, 0.17);
}

TEST(CalibrationPictures, NameViewsByWhatDiffers) {
  const std::string svg =
      DrawViewBars({{"br0_cam01-2020-05-07-13-08-27", .1, .2, 0},
                    {"br0_cam01-2020-05-07-14-00-30", .3, kNotKnown, 2},
                    {"br0_cam01-2020-05-07-14-01-07", kNotKnown, kNotKnown, 0}});
  ExpectSound(svg, "views");
  EXPECT_TRUE(Has(svg, ">13-08-27<"));
  EXPECT_TRUE(Has(svg, "14-00-30: 0.3 px, 2 set aside"));
}

TEST(CalibrationPictures, ShowTheBoardInMillimetres) {
  BoardPicture picture;
  for (int x = 0; x < 5; ++x)
    for (int y = 0; y < 4; ++y)
      picture.corners.push_back({.1 * x, .1 * y, 1e-4 * x, 0, 1e-3 * (x - 2)});
  const std::string svg = DrawBoard(picture);
  ExpectSound(svg, "board");
  EXPECT_TRUE(Has(svg, "heights from -2 to 2 mm, root mean square 1.41 mm"));
  EXPECT_TRUE(Has(svg, "the longest is 0.4 mm"));
}

TEST(CalibrationPictures, TellModelsApart) {
  TriedModel good{"angular4", "flat", 8, .19, .15, .2, .5, .9, 0, 0, 0, true, true, ""};
  TriedModel fair{"unified", "flat", 5, .2, .16, .21, .5, .9, .01, .004, 136, true, false, ""};
  TriedModel bad;
  bad.name = "pinhole";
  bad.failure = "bends rays otherwise: 37 px off at best";
  const std::string svg = DrawModels("Camera models", {good, fair, bad});
  ExpectSound(svg, "models");
  EXPECT_TRUE(Has(svg, ">136<"));
  EXPECT_TRUE(Has(svg, "bends rays otherwise"));
}

TEST(CalibrationPictures, ShowWhatIsNotThere) {
  ExpectSound(DrawErrorMap({}), "map");
  ExpectSound(DrawResiduals({}), "residuals");
  ExpectSound(DrawResidualHistogram({}, kNotKnown), "histogram");
  ExpectSound(DrawViewBars({}), "views");
  ExpectSound(DrawCoverage({}), "coverage");
  ExpectSound(DrawUndistortion({}), "undistortion");
  ExpectSound(DrawCrossSection({}), "section");
  ExpectSound(DrawDistortion({}), "distortion");
  ExpectSound(DrawBoard({}), "board");
  ExpectSound(DrawSuggestion({}), "suggestion");
  ExpectSound(DrawModels("", {}), "models");
  ExpectSound(CalibrationReportHtml({}), "report");
  EXPECT_NO_THROW(PngFromSvg(DrawErrorMap({}), 200));
}

TEST(CalibrationPictures, ShrinkImagesByTheMeanOfTheirShades) {
  const GreyImage small = ShrinkImage({4, 2, {0, 100, 50, 50, 100, 200, 50, 50}}, 2, 2);
  EXPECT_EQ(small.width, 2u);
  EXPECT_EQ(small.height, 1u);
  EXPECT_EQ(small.shades, (std::vector<std::uint8_t>{100, 50}));
}

CalibrationReport Report() {
  CalibrationReport report;
  report.title = "Calibration of <cam0>";
  report.accuracy_px = 1;
  report.verdict = CalibrationVerdict::kNotMet;
  report.advice = {"Tilt the target"};
  report.facts = {{"views", "2"}};
  report.warnings = {"1 view left out"};
  report.timings = {{"calibrate", 1.25}};
  ReportedError held_out;
  held_out.name = "held out";
  held_out.corners = 10;
  held_out.rms_px = 0.169;
  report.errors = {held_out};
  CameraReport camera;
  camera.camera = {"cam0", "angular4", 641, 481, {}};
  camera.numbers = {{"fx", "px", 208.3041234, .069, true}, {"k4", "", .0027, 3, false}};
  camera.views = {{"left01.jpg", 54, 1, .1, .3, .2, 1.5, 32, ""},
                  {"left02.jpg", 0, 0, kNotKnown, kNotKnown, kNotKnown, kNotKnown, kNotKnown,
                   "no pose explains it"}};
  camera.max_ere_px = 4.84;
  camera.max_ere_at = {0, 240};
  camera.max_ere_variants = {{"raw", 4.9}};
  camera.maps = {Bowl()};
  camera.residuals.corners = {{0, 3, {10, 20}, {.1, 0}, false}, {0, 4, {30, 20}, {5, 0}, true}};
  camera.coverage.width = 641;
  camera.coverage.height = 481;
  camera.coverage.corners = {{10, 20}, {30, 20}};
  camera.coverage.rings = {{10, {{{200, 200}, {500, 200}}}}};
  camera.section = CrossSection{};
  camera.section->curves = {{"expected", {{0, .1}, {400, 4}}}};
  camera.section->limit_px = 1;
  camera.section->seen_to_px = 300;
  camera.distortion = DistortionCurve{"angular4", 200, {{0, 0, 0}, {60, 200, .5}}, 50, 20};
  camera.suggestion = SuggestionPicture{};
  camera.suggestion->width = 641;
  camera.suggestion->height = 481;
  camera.suggestion->quads = {{{10, 10}, {50, 10}, {50, 50}, {10, 50}}};
  camera.suggestion->advice = {"closer"};
  report.cameras = {camera};
  report.board = BoardPicture{};
  report.board->corners = {{0, 0, 0, 0, 0}, {1, 0, 0, 0, .001}, {0, 1, 0, 0, 0}};
  report.models = {{"angular4", "flat", 8, .1, .1, .1, .2, .3, 0, 0, 0, true, true, ""}};
  return report;
}

TEST(CalibrationReport, SaysWhetherItIsGoodEnough) {
  CalibrationReport report = Report();
  EXPECT_EQ(CalibrationVerdictText(report),
            "The largest expected reprojection error is 4.84 px, at (0, 240): above the 1 px asked "
            "for.");
  report.verdict = CalibrationVerdict::kUnconstrained;
  report.unconstrained = {"k3 of cam0", "k4 of cam0"};
  EXPECT_EQ(CalibrationVerdictText(report),
            "These views do not constrain k3 of cam0 and k4 of cam0.");
  report.verdict_text = "so it is";
  EXPECT_EQ(CalibrationVerdictText(report), "so it is");
}

TEST(CalibrationReport, IsOneSoundPage) {
  const std::string page = CalibrationReportHtml(Report());
  ExpectSound(page, "page");
  EXPECT_TRUE(test::IsSelfContained(page));
  for (const char* text :
       {"Calibration of &lt;cam0&gt;", "not accurate enough", "208.304", "0.069", "not constrained",
        "left01.jpg", "no pose explains it", "1 corner was set aside", "Tilt the target", "1.25 s",
        "closer", "last corner that was seen", "widest corner that was seen", "0.169 px rms"})
    EXPECT_TRUE(Has(page, text)) << text;
  EXPECT_EQ(test::Count(page, "<figure>"), CalibrationPictures(Report()).size());
  EXPECT_EQ(page, CalibrationReportHtml(Report()));
}

TEST(CalibrationReport, HasPicturesThatAreNotEmpty) {
  for (const NamedPicture& picture : CalibrationPictures(Report())) {
    ExpectSound(picture.svg, picture.name);
    EXPECT_GT(test::ReadPng(PngFromSvg(picture.svg, 300)).Colours(), 5u) << picture.name;
  }
}

TEST(CalibrationReport, IsReadByPrograms) {
  const auto json = nlohmann::json::parse(CalibrationReportJson(Report()));
  EXPECT_EQ(json["schema"], "graticule-calibration/1");
  EXPECT_EQ(json["verdict"], "not_met");
  const auto& camera = json["cameras"][0];
  EXPECT_EQ(camera["max_ere_px"], 4.84);
  EXPECT_EQ(camera["parameters"][0]["value"], 208.3041234);
  EXPECT_EQ(camera["parameters"][1]["constrained"], false);
  EXPECT_TRUE(camera["views"][1]["rms_px"].is_null());
  EXPECT_EQ(camera["outliers"][0]["image"], "left01.jpg");
  EXPECT_EQ(camera["maps"][0]["px"].size(), 65u * 49u);
  EXPECT_EQ(json["timings_s"]["calibrate"], 1.25);
  EXPECT_NO_THROW(nlohmann::json::parse(CalibrationReportJson({})));
}

}  // namespace
}  // namespace graticule
