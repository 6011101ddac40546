// PCD, the Point Cloud Library's format (pointclouds.org: "The PCD file format").

#include <lzf.h>

#include <vector>

#include "graticule/io/cloud_fields.hpp"
#include "graticule/io/cloud_files.hpp"
#include "graticule/io/cloud_write.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::size_t kMostFields = 1024, kMostOfAField = 4096;
constexpr std::uint64_t kMostOfASide = 1000000000;

enum class PcdBody { kText, kBinary, kCompressed };

struct PcdHeader {
  CloudFields fields;
  std::size_t width = 0, height = 1, points = 0;
  PcdBody body = PcdBody::kText;
  std::size_t body_offset = 0;
};

std::uint64_t Bounded(TextReader* reader, const char* what, std::uint64_t most) {
  const std::uint64_t number = reader->Integer(what);
  if (number > most)
    reader->Fail("expected " + std::string(what) + " up to " + std::to_string(most) + ", found " +
                 std::to_string(number));
  return number;
}

// One word a field, of the lines SIZE, TYPE and COUNT.
template <class Read>
void ReadForEach(TextReader* reader, std::vector<CloudField>* fields, Read read) {
  if (fields->empty()) reader->Fail("expected FIELDS before this line");
  for (CloudField& field : *fields) read(&field);
}

void ReadLine(TextReader* reader, std::string_view key, std::vector<CloudField>* fields,
              PcdHeader* header, bool* has_size, bool* has_type) {
  if (key == "VERSION") {
    reader->Word("the version");
  } else if (key == "FIELDS" || key == "COLUMNS") {
    if (!fields->empty()) reader->Fail("the fields are there already");
    while (!reader->AtLineEnd()) {
      if (fields->size() == kMostFields) reader->Fail("expected at most 1024 fields");
      fields->push_back({std::string(reader->Word("the name of a field"))});
    }
  } else if (key == "SIZE") {
    *has_size = true;
    ReadForEach(reader, fields, [&](CloudField* field) {
      field->size = Bounded(reader, "the size of a field", 8);
      if (field->size == 0 || (field->size & (field->size - 1)) != 0)
        reader->Fail("expected a field of 1, 2, 4 or 8 bytes, found " +
                     std::to_string(field->size));
    });
  } else if (key == "TYPE") {
    *has_type = true;
    ReadForEach(reader, fields, [&](CloudField* field) {
      const std::string_view word = reader->Word("the type of a field");
      if (word != "I" && word != "U" && word != "F")
        reader->Fail("expected a type I, U or F, found " + Quoted(word));
      field->kind = word[0];
    });
  } else if (key == "COUNT") {
    ReadForEach(reader, fields, [&](CloudField* field) {
      field->count = Bounded(reader, "the count of a field", kMostOfAField);
    });
  } else if (key == "WIDTH") {
    header->width = Bounded(reader, "the width", kMostOfASide);
  } else if (key == "HEIGHT") {
    header->height = Bounded(reader, "the height", kMostOfASide);
  } else if (key == "VIEWPOINT") {
    for (int i = 0; i < 7; ++i) reader->Double("the viewpoint");
  } else if (key == "POINTS") {
    const std::uint64_t points = reader->Integer("the number of points");
    if (points != header->width * header->height)
      reader->Fail("expected " + std::to_string(header->width) + " x " +
                   std::to_string(header->height) + " points, found " + std::to_string(points));
  } else {
    reader->Fail("expected a line of a PCD header, found " + Quoted(key));
  }
}

PcdHeader ReadHeader(TextReader* reader, std::string_view bytes) {
  PcdHeader header;
  std::vector<CloudField> fields;
  bool has_size = false, has_type = false;
  while (true) {
    if (!reader->NextLine())
      reader->FailAt(bytes.size(), "expected DATA, found the end of the file");
    const std::string_view key = reader->Word();
    if (key[0] == '#') continue;
    if (key == "DATA") break;
    ReadLine(reader, key, &fields, &header, &has_size, &has_type);
    reader->ExpectEnd();
  }
  if (!has_size || !has_type) reader->Fail("expected FIELDS, SIZE and TYPE before DATA");
  for (const CloudField& field : fields)
    if (field.kind == 'F' && field.size < 4)
      reader->Fail("there is no float of " + std::to_string(field.size) + " bytes (" +
                   Quoted(field.name) + ")");
  if (const auto wrong = header.fields.SetFields(fields)) reader->Fail(*wrong);
  header.points = header.width * header.height;
  if (header.points == 0) reader->Fail("there is no point in this cloud");
  if (header.points > kMostPoints)
    reader->Fail("expected at most 2^32 - 1 points, found " + std::to_string(header.points));
  const std::string_view word = reader->Word("the kind of DATA");
  if (word == "binary") {
    header.body = PcdBody::kBinary;
  } else if (word == "binary_compressed") {
    header.body = PcdBody::kCompressed;
  } else if (word != "ascii") {
    reader->Fail("expected ascii, binary or binary_compressed, found " + Quoted(word));
  }
  const std::size_t end = bytes.find('\n', reader->WordOffset());
  if (end == std::string_view::npos)
    reader->FailAt(bytes.size(), "expected points, found the end of the file");
  header.body_offset = end + 1;
  return header;
}

void ReadBinary(const PcdHeader& header, const CloudBytes& file, PointCloud* cloud) {
  const std::size_t held = file.bytes.size() - header.body_offset;
  const std::size_t needed = header.points * header.fields.PointBytes();
  if (held < needed)
    FailAtByte(file.name, file.bytes.size(),
               "the file is cut short: expected " + std::to_string(needed) + " bytes of points, " +
                   "found " + std::to_string(held));
  std::vector<CloudPlace> places;
  std::size_t at = header.body_offset;
  for (const CloudField& field : header.fields.Fields()) {
    places.push_back({at, header.fields.PointBytes()});
    at += field.Bytes();
  }
  header.fields.ReadBinary(file, places, header.points, cloud);
}

// Two sizes, then LZF of all x, all y, and so on.
void ReadCompressed(const PcdHeader& header, const CloudBytes& file, PointCloud* cloud) {
  const std::size_t begin = header.body_offset;
  if (file.bytes.size() - begin < 8)
    FailAtByte(file.name, file.bytes.size(), "the file is cut short in its sizes");
  const std::uint64_t packed = UnsignedAt(file.bytes.data() + begin, 4, false);
  const std::uint64_t unpacked = UnsignedAt(file.bytes.data() + begin + 4, 4, false);
  if (unpacked != header.points * header.fields.PointBytes())
    FailAtByte(file.name, begin + 4,
               "expected " + std::to_string(header.points * header.fields.PointBytes()) +
                   " bytes when unpacked, found " + std::to_string(unpacked));
  if (packed > file.bytes.size() - begin - 8)
    FailAtByte(file.name, file.bytes.size(),
               "the file is cut short: expected " + std::to_string(packed) +
                   " packed bytes, found " + std::to_string(file.bytes.size() - begin - 8));
  // Three bytes stand for 264 at most.
  if (unpacked > 88 * packed)
    FailAtByte(file.name, begin, "so few packed bytes cannot hold so many points");
  std::string body(unpacked, '\0');
  if (lzf_decompress(file.bytes.data() + begin + 8, static_cast<unsigned>(packed), body.data(),
                     static_cast<unsigned>(unpacked)) != unpacked)
    FailAtByte(file.name, begin + 8, "the packed points are damaged");
  std::vector<CloudPlace> places;
  std::size_t at = 0;
  for (const CloudField& field : header.fields.Fields()) {
    places.push_back({at, field.Bytes()});
    at += field.Bytes() * header.points;
  }
  header.fields.ReadBinary({body, file.name}, places, header.points, cloud);
}

}  // namespace

PointCloud ParsePcd(std::string_view bytes, const std::string& name) {
  TextReader reader(bytes, name);
  if (bytes.empty()) reader.FailAt(0, "the file is empty");
  const PcdHeader header = ReadHeader(&reader, bytes);
  PointCloud cloud;
  cloud.width = header.width;
  cloud.height = header.height;
  const CloudBytes file{bytes, name};
  switch (header.body) {
    case PcdBody::kBinary:
      ReadBinary(header, file, &cloud);
      break;
    case PcdBody::kCompressed:
      ReadCompressed(header, file, &cloud);
      break;
    case PcdBody::kText:
      reader.ExpectEnd();
      // A number and a blank are two bytes.
      if (header.points * header.fields.NumbersOfPoint() * 2 >
          bytes.size() - header.body_offset + 1)
        reader.FailAt(bytes.size(),
                      "the file is too short for " + std::to_string(header.points) + " points");
      header.fields.ReadText(&reader, header.points, &cloud);
      if (reader.NextLine())
        reader.FailAt(reader.Offset(), "expected the end of the file (after the last point)");
  }
  return cloud;
}

std::string FormatPcd(const PointCloud& cloud) {
  std::string fields = "x y z", sizes = "4 4 4", types = "F F F", counts = "1 1 1";
  const auto add = [&](const char* name, const char* type) {
    fields += std::string(" ") + name;
    sizes += " 4";
    types += std::string(" ") + type;
    counts += " 1";
  };
  // The types that PCL's own points have.
  if (!cloud.colours.empty()) add("rgb", "F");
  if (!cloud.intensities.empty()) add("intensity", "F");
  if (!cloud.labels.empty()) add("label", "U");
  std::string bytes = "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields +
                      "\nSIZE " + sizes + "\nTYPE " + types + "\nCOUNT " + counts + "\nWIDTH " +
                      std::to_string(cloud.width) + "\nHEIGHT " + std::to_string(cloud.height) +
                      "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(cloud.Size()) +
                      "\nDATA binary\n";
  for (std::size_t i = 0; i < cloud.Size(); ++i) {
    for (int k = 0; k < 3; ++k) AppendFloat(&bytes, cloud.in_sensor[i][k]);
    if (!cloud.colours.empty()) {
      const Rgb& colour = cloud.colours[i];
      AppendUnsigned(&bytes,
                     static_cast<std::uint32_t>(colour[0] << 16 | colour[1] << 8 | colour[2]));
    }
    if (!cloud.intensities.empty()) AppendFloat(&bytes, cloud.intensities[i]);
    if (!cloud.labels.empty()) AppendUnsigned(&bytes, cloud.labels[i]);
  }
  return bytes;
}

}  // namespace graticule
