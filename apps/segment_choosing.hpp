#pragma once

#include <string>
#include <vector>

#include "commands.hpp"
#include "graticule/problems/segmentation/segmenter.hpp"

namespace graticule::apps {

/// The method's options for this cloud, with what was asked for.
SegmentOptions OptionsOf(SegmentMethod method, const SegmentChoosing& choosing,
                         const PointCloud& cloud);

/// A number of segmentation, by its option's name.
struct SegmentParameter {
  const char *name, *label;  ///< "grazing", "grazing [degrees]"
  double SegmentChoosing::*number;
  double least, most;
  bool is_whole;
  bool (*matters)(SegmentMethod method);
  double (*value)(const SegmentOptions& options);

  bool Allows(double value) const;
};

/// Those that matter to a method.
std::vector<SegmentParameter> ParametersOf(SegmentMethod method);

/// Throws Error (kUsage): no such parameter.
const SegmentParameter& ParameterOf(const std::string& name);

}  // namespace graticule::apps
