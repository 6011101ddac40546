#include "graticule/io/grey_image.hpp"

#include <png.h>

#include <charconv>
#include <cstring>
#include <limits>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::size_t kMostShades = std::numeric_limits<std::int32_t>::max();

[[noreturn]] void Refuse(const std::string& name, const std::string& why) {
  throw Error(name + ": " + why);
}

std::size_t CheckedSize(std::size_t width, std::size_t height, const std::string& name) {
  if (width == 0 || height == 0) Refuse(name, "the picture has no pixels");
  if (width > kMostShades / height) Refuse(name, "the picture has more than 2^31 pixels");
  return width * height;
}

// The header of a PGM: numbers between white space and comments.
class PgmHeader {
 public:
  PgmHeader(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  std::size_t Number(const char* what) {
    while (at_ < text_.size() && (IsSpace(text_[at_]) || text_[at_] == '#'))
      if (text_[at_] == '#')
        at_ = std::min(text_.find('\n', at_), text_.size());
      else
        ++at_;
    std::size_t number = 0;
    const auto [end, error] =
        std::from_chars(text_.data() + at_, text_.data() + text_.size(), number);
    if (error != std::errc())
      Refuse(name_, std::string("expected ") + what + " in the header of the PGM picture");
    at_ = static_cast<std::size_t>(end - text_.data());
    return number;
  }
  std::size_t At() const { return at_; }

 private:
  static bool IsSpace(char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; }

  std::string_view text_;
  const std::string& name_;
  std::size_t at_ = 2;
};

GreyImage ParsePgm(std::string_view contents, const std::string& name) {
  PgmHeader header(contents, name);
  GreyImage image;
  image.width = header.Number("the width");
  image.height = header.Number("the height");
  const std::size_t size = CheckedSize(image.width, image.height, name);
  const std::size_t white = header.Number("the value of white");
  if (white == 0 || white > 65535)
    Refuse(name, "expected the value of white in 1 to 65535, found " + std::to_string(white));
  const auto shade = [&](std::size_t value) {
    return static_cast<std::uint8_t>((std::min(value, white) * 255 + white / 2) / white);
  };
  const bool is_text = contents[1] == '2';
  const std::size_t bytes = white > 255 ? 2 : 1, first = header.At() + 1;
  // Before anything is reserved: a header may promise what the file does not hold.
  const std::size_t least = is_text ? 2 * size - 1 : bytes * size;
  if (contents.size() < first || contents.size() - first < least)
    Refuse(name, "the picture is cut short: expected " + std::to_string(size) + " pixels");
  image.shades.reserve(size);
  for (std::size_t i = 0; i < size; ++i) {
    if (is_text) {
      image.shades.push_back(shade(header.Number("a pixel")));
      continue;
    }
    std::size_t value = 0;
    for (std::size_t k = 0; k < bytes; ++k)
      value = 256 * value + static_cast<unsigned char>(contents[first + i * bytes + k]);
    image.shades.push_back(shade(value));
  }
  return image;
}

// libpng's own structure, which has to be freed whatever happens.
struct PngImage {
  png_image png{};
  PngImage() { png.version = PNG_IMAGE_VERSION; }
  ~PngImage() { png_image_free(&png); }
};

GreyImage ParsePng(std::string_view contents, const std::string& name) {
  PngImage reader;
  if (!png_image_begin_read_from_memory(&reader.png, contents.data(), contents.size()))
    Refuse(name, std::string("the PNG picture cannot be read: ") + reader.png.message);
  GreyImage image;
  image.width = reader.png.width;
  image.height = reader.png.height;
  const std::size_t size = CheckedSize(image.width, image.height, name);
  // Deflate packs 1032 bytes into one at best, and a pixel has a bit or more.
  if (size / 8 / 1032 > contents.size())
    Refuse(name, "the PNG picture is cut short: its header promises " + std::to_string(size) +
                     " pixels in " + std::to_string(contents.size()) + " bytes");
  // As it stands in the file, without gamma: colours are labels here.
  reader.png.format = PNG_FORMAT_RGBA;
  std::vector<std::uint8_t> pixels(4 * size);
  if (!png_image_finish_read(&reader.png, nullptr, pixels.data(), 0, nullptr))
    Refuse(name, std::string("the PNG picture cannot be read: ") + reader.png.message);
  image.shades.reserve(size);
  for (std::size_t i = 0; i < size; ++i)
    image.shades.push_back(
        static_cast<std::uint8_t>((pixels[4 * i] + pixels[4 * i + 1] + pixels[4 * i + 2] + 1) / 3));
  return image;
}

}  // namespace

GreyImage ParseGreyImage(std::string_view contents, const std::string& name) {
  if (contents.size() > 2 && contents[0] == 'P' && (contents[1] == '2' || contents[1] == '5'))
    return ParsePgm(contents, name);
  if (contents.size() >= 8 &&
      png_sig_cmp(reinterpret_cast<png_const_bytep>(contents.data()), 0, 8) == 0)
    return ParsePng(contents, name);
  Refuse(name, "expected a picture: PGM (P2, P5) or PNG");
}

std::string FormatPgm(const GreyImage& image) {
  std::string text =
      "P5\n" + std::to_string(image.width) + " " + std::to_string(image.height) + "\n255\n";
  const std::size_t header = text.size();
  text.resize(header + image.shades.size());
  std::memcpy(text.data() + header, image.shades.data(), image.shades.size());
  return text;
}

std::string FormatPng(const GreyImage& image) {
  PngImage writer;
  writer.png.width = static_cast<png_uint_32>(image.width);
  writer.png.height = static_cast<png_uint_32>(image.height);
  writer.png.format = PNG_FORMAT_GRAY;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(writer.png);
  std::string png(size, '\0');
  if (!png_image_write_to_memory(&writer.png, png.data(), &size, 0, image.shades.data(), 0,
                                 nullptr))
    throw Error(std::string("the picture could not be packed: ") + writer.png.message,
                ErrorKind::kOther);
  png.resize(size);
  return png;
}

}  // namespace graticule
