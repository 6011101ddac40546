#pragma once

#include <optional>
#include <string_view>

#include "graticule/io/grey_image.hpp"
#include "graticule/io/image_field.hpp"
#include "graticule/io/svg.hpp"

namespace graticule {

/// Part of a drawing that shows the plane of an image, as large as fits.
class ImagePanel {
 public:
  /// Its upper left corner in the drawing, and how wide and tall it may be.  An image without size
  /// counts as one of one pixel.
  ImagePanel(int width, int height, double left, double top, double most_width, double most_height);

  double Left() const { return left_; }
  double Top() const { return top_; }
  double Width() const { return width_ * scale_; }
  double Height() const { return height_ * scale_; }
  double Right() const { return left_ + Width(); }
  double Bottom() const { return top_ + Height(); }
  double Scale() const { return scale_; }  ///< pixels of the drawing a pixel of the image

  /// Place of a point in the panel; the image's edge is half a pixel outside of its pixels'
  /// centres.
  double X(double x) const { return (x + 0.5) * scale_; }
  double Y(double y) const { return (y + 0.5) * scale_; }

  /// What is drawn until Close is cut off at the panel's edge, and is placed by X and Y.
  void Open(const std::optional<GreyImage>& image, Svg* svg) const;
  /// Also draws the frame.
  void Close(Svg* svg) const;

  /// Adds the parts of a line that are finite.
  void AddLine(const std::vector<ImagePoint>& line, bool closed, PathData* path) const;
  /// Text on a plate beside a point of the panel, inside it.
  void Label(const ImagePoint& at, std::string_view text, Svg* svg) const;

 private:
  int width_, height_;
  double left_, top_, scale_;
};

/// A drawing's title; the height that it takes.
double DrawPictureTitle(std::string_view title, std::string_view subtitle, double width, Svg* svg);

/// An image no larger than asked for, shades averaged.
GreyImage ShrinkImage(const GreyImage& image, std::size_t most_width, std::size_t most_height);

}  // namespace graticule
