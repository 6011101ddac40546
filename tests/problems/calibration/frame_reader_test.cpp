#include "graticule/io/frame_reader.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <opencv2/videoio.hpp>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

struct Film {
  std::string path = (std::filesystem::temp_directory_path() /
                      ("graticule_film_" + std::to_string(getpid()) + ".avi"))
                         .string();
  ~Film() { std::remove(path.c_str()); }
};

TEST(FrameReader, ReadsAFilmInGreyToItsEnd) {
  const Film film;
  {
    cv::VideoWriter video(film.path, cv::CAP_OPENCV_MJPEG,
                          cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 12, {64, 48});
    ASSERT_TRUE(video.isOpened());
    for (int i = 0; i < 5; ++i)
      video.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar(40 * i, 40 * i, 40 * i)));
  }
  FrameReader reader = FrameReader::OfVideo(film.path);
  EXPECT_NEAR(reader.Rate(), 12, .01);
  for (int i = 0; i < 5; ++i) {
    const auto frame = reader.Next();
    ASSERT_TRUE(frame) << i;
    EXPECT_EQ(frame->width, 64u);
    EXPECT_EQ(frame->height, 48u);
    EXPECT_NEAR(frame->shades[1000], 40 * i, 3) << i;
  }
  EXPECT_FALSE(reader.Next());
  EXPECT_FALSE(reader.Next());
}

TEST(FrameReader, RefusesWhatIsNoFilmAndNoCamera) {
  const Film film;
  EXPECT_THROW(FrameReader::OfVideo(film.path), Error);
  std::ofstream(film.path) << "words";
  EXPECT_THROW(FrameReader::OfVideo(film.path), Error);
  EXPECT_THROW(FrameReader::OfCamera(250), Error);
}

}  // namespace
}  // namespace graticule
