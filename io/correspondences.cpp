#include "graticule/io/correspondences.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "graticule/io/comma_separated.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/text.hpp"

namespace graticule {
namespace {

constexpr double kFarthest = 1e6;  // m, px

double Bounded(TextReader* reader, const char* what) {
  const double value = reader->Double(what);
  if (std::abs(value) > kFarthest) {
    reader->Seek(reader->WordOffset());
    reader->Fail("expected " + std::string(what) + " within 1e6, found " + Quoted(reader->Word()));
  }
  return value;
}

void RefuseCutEnd(const std::string& text, const TextReader& reader) {
  if (text.back() != '\n')
    reader.FailAt(text.size(), "expected the end of the line: the file may be cut short");
}

}  // namespace

std::vector<Correspondence> ParseCorrespondences(std::string_view original,
                                                 const std::string& name) {
  const std::string text = CommasAsBlanks(original, name);
  TextReader reader(text, name);
  if (text.empty()) reader.FailAt(0, "the file is empty");
  std::vector<Correspondence> points;
  std::set<std::string, std::less<>> names;
  while (reader.NextLine()) {
    const std::size_t line = reader.Offset();
    const std::string_view first = reader.Word();
    if (first[0] == '#' || first == "x") continue;
    reader.Seek(line);
    Correspondence point;
    point.in_lidar[0] = Bounded(&reader, "x of the point");
    point.in_lidar[1] = Bounded(&reader, "y of the point");
    point.in_lidar[2] = Bounded(&reader, "z of the point");
    point.pixel[0] = Bounded(&reader, "u of the pixel");
    point.pixel[1] = Bounded(&reader, "v of the pixel");
    point.name = reader.AtLineEnd() ? std::to_string(points.size() + 1)
                                    : std::string(reader.Word("the name"));
    reader.ExpectEnd();
    if (!names.insert(point.name).second)
      reader.Fail("the name " + Quoted(point.name) + " is there already");
    points.push_back(std::move(point));
  }
  if (points.empty()) reader.FailAt(0, "there is no correspondence in this file");
  RefuseCutEnd(text, reader);
  return points;
}

std::vector<Correspondence> ReadCorrespondences(const std::string& path) {
  return ParseCorrespondences(ReadFile(path), path);
}

std::string FormatCorrespondences(const std::vector<Correspondence>& points) {
  std::string text = "x,y,z,u,v,name\n";
  for (const Correspondence& point : points) {
    for (const double value : point.in_lidar) {
      AppendNumber(&text, value);
      text += ',';
    }
    for (const double value : point.pixel) {
      AppendNumber(&text, value);
      text += ',';
    }
    text += point.name + "\n";
  }
  return text;
}

std::vector<MeasuredPlane> ParsePlanes(std::string_view original, const std::string& name) {
  const std::string text = CommasAsBlanks(original, name);
  TextReader reader(text, name);
  if (text.empty()) reader.FailAt(0, "the file is empty");
  std::vector<MeasuredPlane> planes;
  std::set<std::string, std::less<>> images;
  while (reader.NextLine()) {
    const std::string_view first = reader.Word();
    if (first[0] == '#' || first == "image") continue;
    MeasuredPlane plane;
    plane.image = first;
    if (!images.insert(plane.image).second)
      reader.Fail("the plane of " + Quoted(plane.image) + " is there already");
    double squared = 0;
    for (double& value : plane.normal) {
      value = Bounded(&reader, "the plane's normal");
      squared += value * value;
    }
    if (!(std::abs(squared - 1) < 1e-3)) reader.Fail("expected a normal of length 1");
    for (double& value : plane.normal) value /= std::sqrt(squared);
    plane.offset_m = Bounded(&reader, "the plane's offset");
    reader.ExpectEnd();
    planes.push_back(std::move(plane));
  }
  if (planes.empty()) reader.FailAt(0, "there is no plane in this file");
  RefuseCutEnd(text, reader);
  return planes;
}

}  // namespace graticule
