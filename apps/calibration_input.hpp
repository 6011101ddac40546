#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "console.hpp"
#include "graticule/io/detections.hpp"
#include "graticule/problems/calibration/target.hpp"

namespace graticule::apps {

/// What a calibration is made from.
struct CalibrationInput {
  Detections detections;
  std::vector<std::string> files;  ///< by view, the image that it is of; "" or none: there is none
  std::optional<Target> target;    ///< where images were looked through
  std::vector<std::string> notes;  ///< what a person should know: skipped images, a guessed target
};

/// The corners that a command's words lead to: recorded detections (.json, .vnl, .orpc), or images
/// (files, folders, patterns, a video, the topic of a ROS bag) in which the target of that
/// description is looked for, or, with none, whatever target they show.  Throws Error, and what
/// `after_image` throws, which is called after each image.
CalibrationInput LoadCalibrationInput(const std::vector<std::string>& sources,
                                      const std::string& target, const std::string& image_topic,
                                      const Console& console,
                                      const std::function<void()>& after_image = {});

/// "cam0 (640 x 480): 13 views, 702 corners".
std::string Described(const Detections& detections);

}  // namespace graticule::apps
