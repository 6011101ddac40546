#include "graticule/problems/calibration/chessboard.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace graticule {
namespace {

constexpr int kGuessSide = 640;   // px: of a board of unknown size
constexpr int kQuickSide = 1000;  // px: larger pictures are looked at smaller first

cv::Mat View(const GreyImage& image) {
  return {static_cast<int>(image.height), static_cast<int>(image.width), CV_8UC1,
          const_cast<std::uint8_t*>(image.shades.data())};
}

SeenChessboard From(const std::vector<cv::Point2f>& points, int columns, int rows) {
  SeenChessboard board{columns, rows, {}};
  for (const cv::Point2f& point : points)
    board.corners.emplace_back(static_cast<double>(point.x), static_cast<double>(point.y));
  return board;
}

double LeastSpacing(const SeenChessboard& board) {
  double least = HUGE_VAL;
  for (int row = 0; row < board.rows; ++row)
    for (int column = 0; column < board.columns; ++column) {
      const auto i = static_cast<std::size_t>(row * board.columns + column);
      const auto down = i + static_cast<std::size_t>(board.columns);
      if (column + 1 < board.columns)
        least = std::min(least, (board.corners[i + 1] - board.corners[i]).norm());
      if (row + 1 < board.rows)
        least = std::min(least, (board.corners[down] - board.corners[i]).norm());
    }
  return least;
}

double Shade(const cv::Mat& image, const Eigen::Vector2d& pixel) {
  const int x = std::clamp(static_cast<int>(std::lround(pixel.x())), 0, image.cols - 1);
  const int y = std::clamp(static_cast<int>(std::lround(pixel.y())), 0, image.rows - 1);
  return image.at<std::uint8_t>(y, x);
}

// Whether the square at larger x and y of corner 0 is darker than the one beside it.
bool BeginsBlack(const cv::Mat& image, const SeenChessboard& board) {
  double difference = 0;
  for (int row = 0; row + 1 < board.rows; ++row)
    for (int column = 0; column + 1 < board.columns; ++column) {
      const auto i = static_cast<std::size_t>(row * board.columns + column);
      const auto down = i + static_cast<std::size_t>(board.columns);
      const Eigen::Vector2d middle = (board.corners[i] + board.corners[i + 1] +
                                      board.corners[down] + board.corners[down + 1]) /
                                     4;
      difference += ((row + column) % 2 == 0 ? -1 : 1) * Shade(image, middle);
    }
  return difference > 0;
}

void Turn(SeenChessboard* board) { std::reverse(board->corners.begin(), board->corners.end()); }

void Order(const cv::Mat& image, SeenChessboard* board) {
  const auto columns = static_cast<std::size_t>(board->columns);
  // x to y turns clockwise in the image: a board is not seen from behind.
  const Eigen::Vector2d x = board->corners[columns - 1] - board->corners[0];
  const Eigen::Vector2d y =
      board->corners[static_cast<std::size_t>(board->rows - 1) * columns] - board->corners[0];
  if (x.x() * y.y() - x.y() * y.x() < 0)
    for (std::size_t row = 0; row < static_cast<std::size_t>(board->rows); ++row)
      std::reverse(board->corners.begin() + static_cast<std::ptrdiff_t>(row * columns),
                   board->corners.begin() + static_cast<std::ptrdiff_t>((row + 1) * columns));
  const Eigen::Vector2d &first = board->corners.front(), &last = board->corners.back();
  if ((board->columns + board->rows) % 2 == 1) {
    // The ends have different colours.
    if (!BeginsBlack(image, *board)) Turn(board);
  } else if (first.x() + first.y() > last.x() + last.y()) {
    Turn(board);
  }
}

// The larger of two sizes is across, where a board of unknown size is seen.
void LayDown(SeenChessboard* board) {
  if (board->columns >= board->rows) return;
  SeenChessboard turned{board->rows, board->columns, {}};
  for (int row = 0; row < turned.rows; ++row)
    for (int column = 0; column < turned.columns; ++column)
      turned.corners.push_back(board->corners[static_cast<std::size_t>(
          (board->rows - 1 - column) * board->columns + row)]);
  *board = std::move(turned);
}

double Smaller(const cv::Mat& image, int most_px, cv::Mat* small) {
  const double scale =
      std::min(1.0, static_cast<double>(most_px) / std::max(image.cols, image.rows));
  if (scale == 1)
    *small = image;
  else
    cv::resize(image, *small, {}, scale, scale, cv::INTER_AREA);
  return scale;
}

void Enlarge(double scale, SeenChessboard* board) {
  for (Eigen::Vector2d& corner : board->corners)
    corner = ((corner.array() + 0.5) / scale - 0.5).matrix();
}

}  // namespace

std::optional<SeenChessboard> FindChessboard(const GreyImage& picture, int columns, int rows,
                                             bool thorough) {
  const cv::Mat image = View(picture);
  std::vector<cv::Point2f> points;
  const auto finish = [&](double scale) {
    SeenChessboard board = From(points, columns, rows);
    Enlarge(scale, &board);
    if (LeastSpacing(board) < 3) return std::optional<SeenChessboard>();
    Order(image, &board);
    return std::optional<SeenChessboard>(std::move(board));
  };
  cv::Mat small;
  const double scale = Smaller(image, kQuickSide, &small);
  const int flags = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE;
  if (cv::findChessboardCorners(small, {columns, rows}, points,
                                flags | (thorough ? 0 : cv::CALIB_CB_FAST_CHECK)))
    return finish(scale);
  if (!thorough) return std::nullopt;
  if (scale < 1 && cv::findChessboardCorners(image, {columns, rows}, points, flags))
    return finish(1);
  if (cv::findChessboardCornersSB(
          small, {columns, rows}, points,
          cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_ACCURACY))
    return finish(scale);
  return std::nullopt;
}

std::optional<SeenChessboard> FindAnyChessboard(const GreyImage& picture) {
  const cv::Mat image = View(picture);
  cv::Mat small, meta;
  const double scale = Smaller(image, kGuessSide, &small);
  std::vector<cv::Point2f> points;
  if (!cv::findChessboardCornersSB(
          small, {3, 3}, points,
          cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_LARGER, meta))
    return std::nullopt;
  if (points.size() != static_cast<std::size_t>(meta.rows) * static_cast<std::size_t>(meta.cols))
    return std::nullopt;
  SeenChessboard board = From(points, meta.cols, meta.rows);
  LayDown(&board);
  Enlarge(scale, &board);
  if (LeastSpacing(board) < 3) return std::nullopt;
  Order(image, &board);
  return board;
}

}  // namespace graticule
