#include "graticule/problems/calibration/marker_detector.hpp"

#include <algorithm>
#include <map>
#include <mutex>
#include <opencv2/imgproc.hpp>

#include "graticule/solver/error.hpp"

extern "C" {
#include <apriltag/apriltag.h>
}

namespace graticule {
namespace {

// libapriltag's pixel (0, 0) is the corner of the upper left one.
constexpr double kPixelCentre = 0.5;

/// A family in libapriltag's form.
class Codes {
 public:
  Codes(const MarkerFamily& family, int border_cells) : name_(family.name) {
    const int n = family.cells;
    // A quarter of the cells, then the same turned clockwise, three times: libapriltag turns a code
    // by moving a quarter of its bits.  The middle of an odd number comes last.
    std::vector<std::pair<int, int>> quarter;
    for (int y = 0; y < n / 2; ++y)
      for (int x = 0; x < (n + 1) / 2; ++x) quarter.emplace_back(x, y);
    std::vector<std::pair<int, int>> cells;
    for (int turn = 0; turn < 4; ++turn)
      for (auto& [x, y] : quarter) {
        cells.emplace_back(x, y);
        std::tie(x, y) = std::make_pair(n - 1 - y, x);
      }
    if (n % 2 == 1) cells.emplace_back(n / 2, n / 2);
    for (const auto& [x, y] : cells) {
      x_.push_back(static_cast<std::uint32_t>(x + border_cells));
      y_.push_back(static_cast<std::uint32_t>(y + border_cells));
    }
    for (const std::vector<std::uint8_t>& code : family.codes) {
      std::uint64_t packed = 0;
      for (const auto& [x, y] : cells)
        packed = packed << 1 | code[static_cast<std::size_t>(y * n + x)];
      codes_.push_back(packed);
    }
    own_.ncodes = static_cast<std::uint32_t>(codes_.size());
    own_.codes = codes_.data();
    own_.width_at_border = n + 2 * border_cells;
    own_.total_width = own_.width_at_border + 2;
    own_.nbits = static_cast<std::uint32_t>(cells.size());
    own_.bit_x = x_.data();
    own_.bit_y = y_.data();
    own_.h = static_cast<std::uint32_t>(2 * family.correctable + 1);
    own_.name = name_.data();
  }
  Codes(const Codes&) = delete;
  Codes& operator=(const Codes&) = delete;

  apriltag_family_t* Get() { return &own_; }

 private:
  std::string name_;
  std::vector<std::uint64_t> codes_;
  std::vector<std::uint32_t> x_, y_;
  apriltag_family_t own_ = {};
};

class Detector {
 public:
  Detector(const MarkerFamily& family, const MarkerOptions& options)
      : codes_(family, options.border_cells), own_(apriltag_detector_create()) {
    own_->quad_decimate = static_cast<float>(options.decimate);
    own_->nthreads = 1;
    apriltag_detector_add_family_bits(own_, codes_.Get(), family.correctable);
  }
  ~Detector() {
    apriltag_detector_remove_family(own_, codes_.Get());
    apriltag_detector_destroy(own_);
  }
  Detector(const Detector&) = delete;
  Detector& operator=(const Detector&) = delete;

  std::vector<SeenMarker> Detect(const cv::Mat& image) {
    image_u8_t view = {image.cols, image.rows, static_cast<std::int32_t>(image.step), image.data};
    zarray_t* const found = apriltag_detector_detect(own_, &view);
    std::map<int, SeenMarker> markers;
    std::map<int, int> counts;
    for (int i = 0; i < zarray_size(found); ++i) {
      apriltag_detection_t* detection = nullptr;
      zarray_get(found, i, &detection);
      SeenMarker& marker = markers[detection->id];
      ++counts[detection->id];
      marker.id = detection->id;
      // Theirs are lower left, lower right, upper right, upper left.
      for (std::size_t k = 0; k < 4; ++k)
        marker.corners[3 - k] = {detection->p[k][0] - kPixelCentre,
                                 detection->p[k][1] - kPixelCentre};
    }
    apriltag_detections_destroy(found);
    std::vector<SeenMarker> list;
    for (const auto& [id, marker] : markers)
      if (counts[id] == 1) list.push_back(marker);
    return list;
  }

 private:
  Codes codes_;
  apriltag_detector_t* own_;
};

}  // namespace

class MarkerDetector::Pool {
 public:
  Pool(const MarkerFamily& family, const MarkerOptions& options)
      : family_(family), options_(options) {}

  std::vector<SeenMarker> Detect(const GreyImage& image) {
    cv::Mat view(static_cast<int>(image.height), static_cast<int>(image.width), CV_8UC1,
                 const_cast<std::uint8_t*>(image.shades.data()));
    cv::Mat shrunk;
    if (options_.shrink_black) {
      cv::dilate(view, shrunk, cv::getStructuringElement(cv::MORPH_RECT, {3, 3}));
      view = shrunk;
    }
    std::unique_ptr<Detector> detector = Take();
    std::vector<SeenMarker> markers = detector->Detect(view);
    if (options_.shrink_black)
      for (SeenMarker& marker : markers) Widen(&marker);
    const std::lock_guard<std::mutex> lock(mutex_);
    idle_.push_back(std::move(detector));
    return markers;
  }

 private:
  // Back to where the edges were before black shrank by a pixel.
  static void Widen(SeenMarker* marker) {
    const std::array<Eigen::Vector2d, 4> shrunk = marker->corners;
    for (std::size_t k = 0; k < 4; ++k)
      for (const std::size_t beside : {(k + 1) % 4, (k + 3) % 4})
        marker->corners[k] += (shrunk[k] - shrunk[beside]).normalized();
  }

  std::unique_ptr<Detector> Take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (idle_.empty()) return std::make_unique<Detector>(family_, options_);
    std::unique_ptr<Detector> detector = std::move(idle_.back());
    idle_.pop_back();
    return detector;
  }

  MarkerFamily family_;
  MarkerOptions options_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Detector>> idle_;
};

MarkerDetector::MarkerDetector(const MarkerFamily& family, const MarkerOptions& options)
    : pool_(std::make_unique<Pool>(family, options)) {}

MarkerDetector::~MarkerDetector() = default;

std::vector<SeenMarker> MarkerDetector::Detect(const GreyImage& image) const {
  return pool_->Detect(image);
}

}  // namespace graticule
