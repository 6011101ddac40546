#include <zlib.h>

#include <algorithm>
#include <limits>

#include "graticule/io/file.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr int kGzipWindow = 15 + 16;  // zlib's way to say: the largest window, gzip's frame

Bytef* Bytes(const char* data) { return reinterpret_cast<Bytef*>(const_cast<char*>(data)); }

uInt Chunk(std::size_t size) {
  return static_cast<uInt>(std::min<std::size_t>(size, std::numeric_limits<uInt>::max()));
}

}  // namespace

std::string Gzip(std::string_view contents) {
  z_stream stream{};
  if (deflateInit2(&stream, 6, Z_DEFLATED, kGzipWindow, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw Error("zlib could not be started", ErrorKind::kOther);
  std::string packed;
  std::size_t fed = 0;
  int state = Z_OK;
  char buffer[1 << 16];
  while (state != Z_STREAM_END) {
    const uInt feed = Chunk(contents.size() - fed);
    stream.next_in = Bytes(contents.data() + fed);
    stream.avail_in = feed;
    stream.next_out = Bytes(buffer);
    stream.avail_out = sizeof(buffer);
    state = deflate(&stream, fed + feed == contents.size() ? Z_FINISH : Z_NO_FLUSH);
    fed += feed - stream.avail_in;
    packed.append(buffer, sizeof(buffer) - stream.avail_out);
  }
  deflateEnd(&stream);
  return packed;
}

std::string Gunzip(std::string_view packed, const std::string& name) {
  z_stream stream{};
  if (inflateInit2(&stream, kGzipWindow) != Z_OK)
    throw Error("zlib could not be started", ErrorKind::kOther);
  struct End {
    z_stream* stream;
    ~End() { inflateEnd(stream); }
  } end{&stream};

  std::string contents;
  std::string buffer(std::size_t{1} << 20, '\0');
  std::size_t fed = 0;
  for (;;) {
    const uInt feed = Chunk(packed.size() - fed);
    stream.next_in = Bytes(packed.data() + fed);
    stream.avail_in = feed;
    stream.next_out = Bytes(buffer.data());
    stream.avail_out = static_cast<uInt>(buffer.size());
    const int state = inflate(&stream, Z_NO_FLUSH);
    fed += feed - stream.avail_in;
    contents.append(buffer, 0, buffer.size() - stream.avail_out);
    if (state == Z_STREAM_END) {
      // `cat a.gz b.gz` is legal gzip; zeros after the end are padding.
      if (packed.find_first_not_of('\0', fed) == std::string_view::npos) return contents;
      inflateReset(&stream);
      continue;
    }
    const std::string place = name + ": the gzip data at byte " + std::to_string(fed);
    if (state == Z_BUF_ERROR || (state == Z_OK && fed == packed.size() && stream.avail_out > 0))
      throw Error(place + " is cut short");
    if (state != Z_OK)
      throw Error(place + " is damaged (" + (stream.msg ? stream.msg : "unknown reason") + ")");
  }
}

}  // namespace graticule
