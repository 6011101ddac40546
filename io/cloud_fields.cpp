#include "graticule/io/cloud_fields.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr double kFarthest = 1e9;  // m: no sensor sees farther, and squares stay within a float

template <class To, class From>
To BitsAs(From from) {
  static_assert(sizeof(To) == sizeof(From));
  To to;
  std::memcpy(&to, &from, sizeof(to));
  return to;
}

double ValueAt(const char* at, char kind, std::size_t size, bool is_big_endian) {
  const std::uint64_t bits = UnsignedAt(at, size, is_big_endian);
  if (kind == 'F')
    return size == 8 ? BitsAs<double>(bits) : BitsAs<float>(static_cast<std::uint32_t>(bits));
  if (kind == 'U') return static_cast<double>(bits);
  switch (size) {
    case 1:
      return static_cast<std::int8_t>(bits);
    case 2:
      return static_cast<std::int16_t>(bits);
    case 4:
      return static_cast<std::int32_t>(bits);
    default:
      return static_cast<double>(static_cast<std::int64_t>(bits));
  }
}

// A number of a text, which may say that there is none.
double NumberOrNan(TextReader* reader, const char* what) {
  for (const char* word : {"nan", "-nan", "NaN", "inf", "-inf"})
    if (reader->Accept(word)) return std::nan("");
  return reader->Double(what);
}

// The largest value of a colour's channel.
double FullScale(const CloudField& field) {
  if (field.kind == 'F') return 1;
  return field.size == 1 ? 255 : 65535;
}

std::uint8_t Channel(double value, const CloudField& field) {
  const double scaled = 255 * value / FullScale(field);
  return scaled > 0 ? static_cast<std::uint8_t>(std::min(255.0, std::round(scaled))) : 0;
}

}  // namespace

std::uint64_t UnsignedAt(const char* at, std::size_t size, bool is_big_endian) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < size; ++i)
    bits |= static_cast<std::uint64_t>(static_cast<unsigned char>(at[i]))
            << 8 * (is_big_endian ? size - 1 - i : i);
  return bits;
}

void FailAtByte(const std::string& name, std::size_t byte, const std::string& message) {
  throw Error(name + ": at byte " + std::to_string(byte) + ": " + message);
}

std::optional<CloudFields::Role> CloudFields::RoleOf(const std::string& name) {
  static constexpr std::pair<const char*, Role> kNames[] = {
      {"x", kX},
      {"y", kY},
      {"z", kZ},
      {"rgb", kPacked},
      {"rgba", kPacked},
      {"r", kRed},
      {"g", kGreen},
      {"b", kBlue},
      {"red", kRed},
      {"green", kGreen},
      {"blue", kBlue},
      {"intensity", kIntensity},
      {"reflectance", kIntensity},
      {"reflectivity", kIntensity},
      {"remission", kIntensity},
      {"label", kLabel},
  };
  for (const auto& [known, role] : kNames)
    if (name == known) return role;
  return std::nullopt;
}

std::optional<std::string> CloudFields::SetFields(std::vector<CloudField> fields) {
  fields_ = std::move(fields);
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    CloudField& field = fields_[i];
    std::optional<Role> role = RoleOf(field.name);
    // Three bytes and whatever is above them, of whatever type they are said to be.
    if (role == kPacked && field.size != 4)
      return "expected 4 bytes of '" + field.name + "', found " + std::to_string(field.size);
    if (role && field.count != 1)
      return "expected one number of '" + field.name + "', found " + std::to_string(field.count);
    if (role) {
      if (field_of_role_[*role]) {
        const std::string& before = fields_[*field_of_role_[*role]].name;
        return Quoted(field.name) + " and " + Quoted(before) + " are one field";
      }
      field_of_role_[*role] = i;
    }
    roles_.push_back(role);
  }
  for (const auto& [role, word] : {std::pair(kX, "x"), std::pair(kY, "y"), std::pair(kZ, "z")})
    if (!field_of_role_[role]) return std::string("there is no field '") + word + "'";
  if (!(field_of_role_[kRed] && field_of_role_[kGreen] && field_of_role_[kBlue]))
    for (const Role role : {kRed, kGreen, kBlue})
      if (field_of_role_[role]) return "expected red, green and blue, found some of them";
  if (field_of_role_[kPacked] && field_of_role_[kRed]) return "the colour is there twice";
  return std::nullopt;
}

std::size_t CloudFields::PointBytes() const {
  std::size_t bytes = 0;
  for (const CloudField& field : fields_) bytes += field.Bytes();
  return bytes;
}

std::size_t CloudFields::NumbersOfPoint() const {
  std::size_t count = 0;
  for (const CloudField& field : fields_) count += field.count;
  return count;
}

void CloudFields::Reserve(std::size_t count, PointCloud* cloud) const {
  cloud->in_sensor.reserve(count);
  if (field_of_role_[kPacked] || field_of_role_[kRed]) cloud->colours.reserve(count);
  if (field_of_role_[kIntensity]) cloud->intensities.reserve(count);
  if (field_of_role_[kLabel]) cloud->labels.reserve(count);
}

std::optional<std::string> CloudFields::Append(const double* values, PointCloud* cloud) const {
  Eigen::Vector3f point;
  bool is_return = true;
  for (int i = 0; i < 3; ++i) {
    const double value = values[kX + i];
    if (!std::isfinite(value)) {
      is_return = false;
    } else if (std::abs(value) > kFarthest) {
      return "expected a coordinate within 1e9 m, found " + Shown(value);
    } else {
      point[i] = static_cast<float>(value);
    }
  }
  cloud->in_sensor.push_back(is_return ? point : kNoReturn);
  if (field_of_role_[kPacked]) {
    const auto packed = static_cast<std::uint32_t>(values[kPacked]);
    cloud->colours.push_back({static_cast<std::uint8_t>(packed >> 16),
                              static_cast<std::uint8_t>(packed >> 8),
                              static_cast<std::uint8_t>(packed)});
  } else if (field_of_role_[kRed]) {
    Rgb colour;
    for (std::size_t i = 0; i < 3; ++i)
      colour[i] = Channel(values[kRed + i], fields_[*field_of_role_[kRed + i]]);
    cloud->colours.push_back(colour);
  }
  if (field_of_role_[kIntensity]) {
    const double value = values[kIntensity];
    if (std::isfinite(value) && std::abs(value) > 1e30)
      return "expected an intensity within 1e30, found " + Shown(value);
    cloud->intensities.push_back(static_cast<float>(value));
  }
  if (field_of_role_[kLabel]) {
    const double value = values[kLabel];
    if (!(value <= 0xffffffff)) return "expected a label below 2^32, found " + Shown(value);
    cloud->labels.push_back(value > 0 ? static_cast<std::uint32_t>(value) : 0);
  }
  return std::nullopt;
}

void CloudFields::ReadBinary(const CloudBytes& file, const std::vector<CloudPlace>& places,
                             std::size_t count, PointCloud* cloud) const {
  Reserve(count, cloud);
  double values[kRoles] = {};
  for (std::size_t point = 0; point < count; ++point) {
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      if (!roles_[i]) continue;
      const char* at = file.bytes.data() + places[i].begin + point * places[i].stride;
      const char kind = *roles_[i] == kPacked ? 'U' : fields_[i].kind;
      values[*roles_[i]] = ValueAt(at, kind, fields_[i].size, file.is_big_endian);
    }
    if (const auto wrong = Append(values, cloud)) {
      const CloudPlace& first = places[*field_of_role_[kX]];
      FailAtByte(file.name, first.begin + point * first.stride,
                 "point " + std::to_string(point) + ": " + *wrong);
    }
  }
}

void CloudFields::ReadText(TextReader* reader, std::size_t count, PointCloud* cloud) const {
  Reserve(count, cloud);
  double values[kRoles] = {};
  for (std::size_t point = 0; point < count; ++point) {
    if (!reader->NextLine())
      reader->FailAt(reader->Size(), "expected " + std::to_string(count) + " points, found " +
                                         std::to_string(point));
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      const CloudField& field = fields_[i];
      if (!roles_[i]) {
        for (std::size_t k = 0; k < field.count; ++k) reader->Word(field.name.c_str());
        continue;
      }
      double value = NumberOrNan(reader, field.name.c_str());
      if (*roles_[i] == kPacked) {
        // A float's text stands for its bits; one that is no number has lost them.
        if (field.kind == 'F' && std::abs(value) > 3e38) reader->Fail("expected a packed colour");
        if (field.kind == 'F')
          value = std::isnan(value) ? 0 : BitsAs<std::uint32_t>(static_cast<float>(value));
        // Some writers print the packed bytes as a signed number.
        if (field.kind == 'I' && value < 0) value += 4294967296.0;
        if (!(value >= 0 && value < 4294967296.0)) reader->Fail("expected a packed colour");
      }
      values[*roles_[i]] = value;
    }
    reader->ExpectEnd();
    if (const auto wrong = Append(values, cloud)) reader->FailAt(reader->LineOffset(), *wrong);
  }
}

}  // namespace graticule
