#pragma once

#include <string_view>

#include "graticule/io/contours.hpp"
#include "graticule/io/image_panel.hpp"

namespace graticule {

/// Fills an open panel with a field's contours; what has no value stays grey.
void DrawContours(const ImageField& field, const ContourLevels& levels, const ImagePanel& panel,
                  Svg* svg);

/// The contour at one level, bold.
void DrawBoldContour(const ImageField& field, double level, const ImagePanel& panel, Svg* svg);

/// Diagonal lines over a region.
void DrawHatching(const FieldRegion& region, const ImagePanel& panel, Svg* svg);

/// What the colours stand for, with the levels' labels; 70 pixels wide.
void DrawColourBar(const ContourLevels& levels, std::string_view unit, double left, double top,
                   double height, Svg* svg);

}  // namespace graticule
