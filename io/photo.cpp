#include "graticule/io/photo.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "graticule/io/file.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// Decoders fill what is missing with grey, and complain on the terminal.
bool IsCutShort(std::string_view contents) {
  using namespace std::string_view_literals;
  if (contents.substr(0, 4) == "\x89PNG"sv) return contents.rfind("IEND") == std::string_view::npos;
  if (contents.substr(0, 2) == "\xff\xd8"sv)
    return contents.rfind("\xff\xd9"sv) == std::string_view::npos;
  return false;
}

cv::Mat Decode(std::string_view contents, const std::string& name, int mode) {
  cv::Mat image;
  if (contents.empty()) throw Error(name + ": the file is empty");
  if (IsCutShort(contents)) throw Error(name + ": the picture is cut short");
  try {
    const cv::Mat bytes(1, static_cast<int>(std::min<std::size_t>(contents.size(), 1u << 30)),
                        CV_8UC1, const_cast<char*>(contents.data()));
    image = cv::imdecode(bytes, mode | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception& error) {
    throw Error(name + ": the picture cannot be read: " + Printable(error.err));
  }
  if (image.empty())
    throw Error(name +
                ": expected a picture (JPEG, PNG, ...), which is neither damaged nor cut short");
  return image;
}

// OpenCV's order of channels.
cv::Mat BlueFirst(const ColourImage& image) {
  cv::Mat out(static_cast<int>(image.height), static_cast<int>(image.width), CV_8UC3);
  const std::uint8_t* in = image.rgb.data();
  for (int row = 0; row < out.rows; ++row) {
    std::uint8_t* to = out.ptr(row);
    for (int i = 0; i < out.cols; ++i, in += 3, to += 3) {
      to[0] = in[2];
      to[1] = in[1];
      to[2] = in[0];
    }
  }
  return out;
}

std::string Encode(const char* ending, const cv::Mat& image, const std::vector<int>& how) {
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(ending, image, bytes, how))
    throw Error("the picture could not be packed", ErrorKind::kOther);
  return {bytes.begin(), bytes.end()};
}

}  // namespace

GreyImage ParseGreyPhoto(std::string_view contents, const std::string& name) {
  const cv::Mat read = Decode(contents, name, cv::IMREAD_GRAYSCALE);
  GreyImage image;
  image.width = static_cast<std::size_t>(read.cols);
  image.height = static_cast<std::size_t>(read.rows);
  image.shades.resize(image.width * image.height);
  for (int row = 0; row < read.rows; ++row)
    std::memcpy(image.shades.data() + static_cast<std::size_t>(row) * image.width, read.ptr(row),
                image.width);
  return image;
}

GreyImage ReadGreyPhoto(const std::string& path) { return ParseGreyPhoto(ReadFile(path), path); }

ColourImage ReadColourPhoto(const std::string& path) {
  const cv::Mat read = Decode(ReadFile(path), path, cv::IMREAD_COLOR);
  ColourImage image;
  image.width = static_cast<std::size_t>(read.cols);
  image.height = static_cast<std::size_t>(read.rows);
  image.rgb.resize(3 * image.width * image.height);
  std::uint8_t* out = image.rgb.data();
  for (int row = 0; row < read.rows; ++row) {
    const std::uint8_t* in = read.ptr(row);
    for (int i = 0; i < read.cols; ++i, in += 3, out += 3) {
      out[0] = in[2];
      out[1] = in[1];
      out[2] = in[0];
    }
  }
  return image;
}

bool IsPhotoName(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  for (const char* known :
       {".jpg", ".jpeg", ".png", ".tif", ".tiff", ".bmp", ".pgm", ".ppm", ".webp", ".jp2"})
    if (ending == known) return true;
  return false;
}

std::string FormatJpeg(const ColourImage& image, int quality) {
  return Encode(".jpg", BlueFirst(image), {cv::IMWRITE_JPEG_QUALITY, quality});
}

std::string FormatJpeg(const GreyImage& image, int quality) {
  return Encode(".jpg",
                cv::Mat(static_cast<int>(image.height), static_cast<int>(image.width), CV_8UC1,
                        const_cast<std::uint8_t*>(image.shades.data())),
                {cv::IMWRITE_JPEG_QUALITY, quality});
}

std::string FormatPng(const ColourImage& image) { return Encode(".png", BlueFirst(image), {}); }

std::string FormatPng16(const std::vector<std::uint16_t>& shades, std::size_t width) {
  return Encode(".png",
                cv::Mat(static_cast<int>(shades.size() / width), static_cast<int>(width), CV_16UC1,
                        const_cast<std::uint16_t*>(shades.data())),
                {});
}

}  // namespace graticule
