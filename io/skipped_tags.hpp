#pragma once

// Internal to the readers of formats whose lines begin with a tag.

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "graticule/io/recording.hpp"
#include "graticule/io/text.hpp"

namespace graticule {

/// Counts the lines whose tag is not known.
class SkippedTags {
 public:
  /// Without permission to skip, Finish refuses what was counted.
  explicit SkippedTags(bool allowed) : allowed_(allowed) {}

  void Add(std::string_view tag, std::size_t offset);
  /// One Error that lists the tags, their counts and the first line; or their record.
  void Finish(const TextReader& reader, const char* format, Recording* recording) const;

 private:
  bool allowed_;
  std::map<std::string, std::size_t, std::less<>> counts_;
  std::size_t lines_ = 0;
  std::size_t first_offset_ = 0;
};

}  // namespace graticule
