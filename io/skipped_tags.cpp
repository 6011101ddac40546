#include "graticule/io/skipped_tags.hpp"

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::size_t kMostTags = 1000;  // junk has a new tag in every line
constexpr std::size_t kMostListed = 8;

}  // namespace

void SkippedTags::Add(std::string_view tag, std::size_t offset) {
  if (lines_++ == 0) first_offset_ = offset;
  tag = tag.substr(0, 60);
  const auto it = counts_.find(tag);
  if (it != counts_.end()) {
    ++it->second;
  } else if (counts_.size() < kMostTags) {
    counts_.emplace(tag, 1);
  }
}

void SkippedTags::Finish(const TextReader& reader, const char* format, Recording* recording) const {
  if (lines_ == 0) return;
  if (allowed_) {
    for (const auto& [tag, count] : counts_) recording->skipped[tag] = count;
    return;
  }
  std::string list;
  std::size_t listed = 0;
  for (const auto& [tag, count] : counts_) {
    if (++listed > kMostListed) {
      list += ", ...";
      break;
    }
    list += (listed > 1 ? ", " : "") + Quoted(tag) + " (" + std::to_string(count) +
            (count == 1 ? " line)" : " lines)");
  }
  reader.FailAt(first_offset_, "expected a tag of a " + std::string(format) + " file, found " +
                                   list + "; --skip-unknown reads the file without them");
}

}  // namespace graticule
