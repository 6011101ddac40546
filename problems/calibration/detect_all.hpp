#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "graticule/io/detections.hpp"
#include "graticule/io/grey_image.hpp"
#include "graticule/problems/calibration/detect.hpp"

namespace graticule {

struct DetectAllOptions {
  std::optional<Target> target;  ///< none: GuessTarget
  DetectOptions detect;
  std::string camera = "cam0";
  std::size_t threads = 0;         ///< 0: as many as there are cores
  std::size_t video_frames = 150;  ///< at most so many of a video or a bag, evenly spaced
  std::string image_topic;         ///< of a ROS bag; "": the only one
};

/// An image without corners, and why.
struct SkippedImage {
  std::string image;
  std::string reason;
};

struct FoundDetections {
  Detections detections;           ///< of one camera a view is an exposure
  std::vector<std::string> files;  ///< by view, the image that it is of; "" of a video's frame
  Target target;
  bool is_guessed = false;            ///< the target: its size is nominal (kNominalPitch_m)
  std::vector<SkippedImage> skipped;  ///< in the order of the images
};

/// Called from one thread at a time: how many of how many images are done.
using DetectProgress = std::function<void(std::size_t done, std::size_t all)>;

/// The images that words on a command line mean: files, the pictures of folders, and patterns with
/// * and ? in their last part; sorted by name within each.  Throws Error: a folder or a pattern
/// without pictures, a file that does not exist.
std::vector<std::string> ExpandImages(const std::vector<std::string>& words);

/// The images of one camera.
struct CameraImages {
  std::string camera;
  std::vector<std::string> images;
};

struct ImagesByCamera {
  std::vector<CameraImages> cameras;
  std::vector<std::string> strays;  ///< whose names belong to none of several cameras
};

/// Sorts images by camera, as their names say: left01.jpg, right01.jpg, or cam0/7.png, cam1/7.png
/// are of two, since what comes before the last number differs, and the numbers are the same.  A
/// few other pictures among them are strays.  All are of one camera ("cam0") where names do not say
/// that.
ImagesByCamera GroupByCamera(const std::vector<std::string>& images);

/// Whether a name ends as videos' do, or as ROS bags (.bag).
bool IsVideoName(const std::string& path);

/// Images of a ROS bag's topic, evenly spaced, at most so many.  Throws Error as BagImages does.
std::vector<GreyImage> ReadBagFrames(const std::string& path, const std::string& topic,
                                     std::size_t most);
/// Frames of a video, evenly spaced, at most so many.  Throws Error: no video.
std::vector<GreyImage> ReadVideoFrames(const std::string& path, std::size_t most);

/// Finds the target in images, or in a video (one name that ends as videos' do), by several
/// threads. The same images give the same result, whatever the number of threads.
///
/// What cannot be read, has another size than most, or does not show the target is skipped and
/// listed.  Throws Error (kInput): no picture can be read, no target is known (with what was
/// looked for), the target is in none of them.
FoundDetections DetectAll(const std::vector<std::string>& images, const DetectAllOptions& options,
                          const DetectProgress& progress = {});

/// The same for the cameras of a rig, which saw one target: exposures are matched as CombineCameras
/// does.  A target that is not described is guessed from the images of all.
FoundDetections DetectCameras(const std::vector<CameraImages>& cameras,
                              const DetectAllOptions& options, const DetectProgress& progress = {});

}  // namespace graticule
