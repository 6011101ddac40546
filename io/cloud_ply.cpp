// PLY, the Stanford polygon format (Turk 1994).

#include <utility>
#include <vector>

#include "graticule/io/cloud_fields.hpp"
#include "graticule/io/cloud_files.hpp"
#include "graticule/io/cloud_write.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

struct PlyProperty {
  CloudField field;
  bool is_list = false;
  CloudField length;  // of a list: what counts it
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
};

enum class PlyBody { kText, kLittle, kBig };

struct PlyHeader {
  PlyBody body = PlyBody::kText;
  std::vector<PlyElement> elements;
  std::size_t columns = 0, rows = 0;  // of a scan in a grid; 0: not said
  std::size_t body_offset = 0;
};

CloudField TypeOf(TextReader* reader) {
  static constexpr struct {
    const char *word, *other;
    char kind;
    std::size_t size;
  } kTypes[] = {{"char", "int8", 'I', 1},     {"uchar", "uint8", 'U', 1},
                {"short", "int16", 'I', 2},   {"ushort", "uint16", 'U', 2},
                {"int", "int32", 'I', 4},     {"uint", "uint32", 'U', 4},
                {"float", "float32", 'F', 4}, {"double", "float64", 'F', 8}};
  const std::string_view word = reader->Word("the type of a property");
  for (const auto& type : kTypes)
    if (word == type.word || word == type.other) return {"", type.kind, type.size};
  reader->Fail("expected a type of PLY such as float or uchar, found " + Quoted(word));
}

void ReadProperty(TextReader* reader, PlyHeader* header) {
  if (header->elements.empty()) reader->Fail("expected an element before this property");
  PlyProperty property;
  if (reader->Accept("list")) {
    property.is_list = true;
    property.length = TypeOf(reader);
    if (property.length.kind == 'F') reader->Fail("expected a whole number that counts a list");
  }
  property.field = TypeOf(reader);
  property.field.name = reader->Word("the name of a property");
  PlyElement& element = header->elements.back();
  if (element.properties.size() == 1024) reader->Fail("expected at most 1024 properties");
  if (property.is_list && element.name == "vertex")
    reader->Fail("expected numbers of a vertex, found a list");
  element.properties.push_back(property);
}

void ReadFormat(TextReader* reader, PlyHeader* header) {
  const std::string_view word = reader->Word("the format");
  if (word == "binary_little_endian") {
    header->body = PlyBody::kLittle;
  } else if (word == "binary_big_endian") {
    header->body = PlyBody::kBig;
  } else if (word != "ascii") {
    reader->Fail("expected ascii, binary_little_endian or binary_big_endian, found " +
                 Quoted(word));
  }
  if (const std::string_view version = reader->Word("the version"); version != "1.0")
    reader->Fail("expected version 1.0, found " + Quoted(version));
}

PlyHeader ReadHeader(TextReader* reader, std::string_view bytes) {
  PlyHeader header;
  if (!reader->NextLine() || reader->Word() != "ply")
    reader->FailAt(0, "expected 'ply' (the first line)");
  bool has_format = false;
  while (true) {
    if (!reader->NextLine())
      reader->FailAt(bytes.size(), "expected end_header, found the end of the file");
    const std::string_view key = reader->Word();
    if (key == "comment") continue;
    if (key == "obj_info") {
      if (reader->Accept("num_cols")) header.columns = reader->Integer("the number of columns");
      if (reader->Accept("num_rows")) header.rows = reader->Integer("the number of rows");
      continue;
    }
    if (key == "end_header") break;
    if (key == "format") {
      has_format = true;
      ReadFormat(reader, &header);
    } else if (key == "element") {
      if (header.elements.size() == 64) reader->Fail("expected at most 64 elements");
      PlyElement element;
      element.name = reader->Word("the name of an element");
      element.count = reader->Integer("the number of these");
      if (element.count > kMostPoints)
        reader->Fail("expected at most 2^32 - 1, found " + std::to_string(element.count));
      header.elements.push_back(std::move(element));
    } else if (key == "property") {
      ReadProperty(reader, &header);
    } else {
      reader->Fail("expected a line of a PLY header, found " + Quoted(key));
    }
    reader->ExpectEnd();
  }
  if (!has_format) reader->Fail("expected the format before end_header");
  const std::size_t end = bytes.find('\n', reader->WordOffset());
  header.body_offset = end == std::string_view::npos ? bytes.size() : end + 1;
  return header;
}

// The elements that are not points have to be passed over; what they hold is not looked at.
class PlySkipper {
 public:
  PlySkipper(const CloudBytes& file, std::size_t at) : file_(file), at_(at) {}

  std::size_t At() const { return at_; }

  void Skip(const PlyElement& element) {
    std::size_t fixed = 0;
    bool has_list = false;
    for (const PlyProperty& property : element.properties) {
      has_list = has_list || property.is_list;
      if (!property.is_list) fixed += property.field.size;
    }
    if (!has_list) return Pass(element.count * fixed, element.name);
    for (std::size_t i = 0; i < element.count; ++i)
      for (const PlyProperty& property : element.properties) {
        std::size_t count = 1;
        if (property.is_list) {
          const std::size_t length = at_;
          Pass(property.length.size, element.name);
          count =
              UnsignedAt(file_.bytes.data() + length, property.length.size, file_.is_big_endian);
        }
        Pass(count * property.field.size, element.name);
      }
  }

  void Pass(std::size_t bytes, const std::string& element) {
    if (bytes > file_.bytes.size() - at_)
      FailAtByte(file_.name, file_.bytes.size(),
                 "the file is cut short in its elements " + Quoted(element) + ": expected " +
                     std::to_string(bytes) + " bytes more at byte " + std::to_string(at_));
    at_ += bytes;
  }

 private:
  const CloudBytes& file_;
  std::size_t at_;
};

void ReadBinary(const PlyHeader& header, const CloudFields& fields, const CloudBytes& file,
                PointCloud* cloud) {
  PlySkipper skipper(file, header.body_offset);
  for (const PlyElement& element : header.elements) {
    const std::size_t begin = skipper.At();
    skipper.Skip(element);
    if (element.name != "vertex") continue;
    std::vector<CloudPlace> places;
    std::size_t at = begin;
    for (const CloudField& field : fields.Fields()) {
      places.push_back({at, fields.PointBytes()});
      at += field.Bytes();
    }
    fields.ReadBinary(file, places, element.count, cloud);
  }
}

void ReadText(const PlyHeader& header, const CloudFields& fields, TextReader* reader,
              PointCloud* cloud) {
  for (const PlyElement& element : header.elements) {
    // A line is two bytes at least.
    if (element.count > reader->Size())
      reader->FailAt(reader->Size(), "the file is too short for " + std::to_string(element.count) +
                                         " of element " + Quoted(element.name));
    if (element.name == "vertex") {
      fields.ReadText(reader, element.count, cloud);
      continue;
    }
    for (std::size_t i = 0; i < element.count; ++i)
      if (!reader->NextLine())
        reader->FailAt(reader->Size(), "expected " + std::to_string(element.count) +
                                           " of element " + Quoted(element.name) + ", found " +
                                           std::to_string(i));
  }
}

}  // namespace

PointCloud ParsePly(std::string_view bytes, const std::string& name) {
  TextReader reader(bytes, name);
  if (bytes.empty()) reader.FailAt(0, "the file is empty");
  const PlyHeader header = ReadHeader(&reader, bytes);
  const PlyElement* vertices = nullptr;
  for (const PlyElement& element : header.elements) {
    if (element.name != "vertex") continue;
    if (vertices) reader.Fail("the element 'vertex' is there twice");
    vertices = &element;
  }
  if (!vertices) reader.Fail("there is no element 'vertex'");
  std::vector<CloudField> listed;
  for (const PlyProperty& property : vertices->properties) listed.push_back(property.field);
  CloudFields fields;
  if (const auto wrong = fields.SetFields(listed)) reader.Fail(*wrong);
  if (vertices->count == 0) reader.Fail("there is no point in this cloud");
  PointCloud cloud;
  cloud.width = vertices->count;
  if (header.columns > 0 || header.rows > 0) {
    if (header.columns == 0 || vertices->count % header.columns != 0 ||
        header.rows != vertices->count / header.columns)
      reader.Fail("expected num_cols x num_rows points, found " + std::to_string(header.columns) +
                  " x " + std::to_string(header.rows) + " and " + std::to_string(vertices->count) +
                  " vertices");
    cloud.width = header.columns;
    cloud.height = header.rows;
  }
  if (header.body == PlyBody::kText) {
    reader.ExpectEnd();
    ReadText(header, fields, &reader, &cloud);
  } else {
    ReadBinary(header, fields, {bytes, name, header.body == PlyBody::kBig}, &cloud);
  }
  return cloud;
}

std::string FormatPly(const PointCloud& cloud) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\n";
  if (cloud.IsOrganised())
    bytes += "obj_info num_cols " + std::to_string(cloud.width) + "\nobj_info num_rows " +
             std::to_string(cloud.height) + "\n";
  bytes += "element vertex " + std::to_string(cloud.Size()) + "\n";
  for (const char* name : {"x", "y", "z"}) bytes += std::string("property float ") + name + "\n";
  if (!cloud.colours.empty())
    for (const char* name : {"red", "green", "blue"})
      bytes += std::string("property uchar ") + name + "\n";
  if (!cloud.intensities.empty()) bytes += "property float intensity\n";
  if (!cloud.labels.empty()) bytes += "property uint label\n";
  bytes += "end_header\n";
  for (std::size_t i = 0; i < cloud.Size(); ++i) {
    for (int k = 0; k < 3; ++k) AppendFloat(&bytes, cloud.in_sensor[i][k]);
    if (!cloud.colours.empty())
      for (const std::uint8_t channel : cloud.colours[i])
        bytes.push_back(static_cast<char>(channel));
    if (!cloud.intensities.empty()) AppendFloat(&bytes, cloud.intensities[i]);
    if (!cloud.labels.empty()) AppendUnsigned(&bytes, cloud.labels[i]);
  }
  return bytes;
}

}  // namespace graticule
