#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace graticule::apps {

/// The folder that a command writes its files to.
class OutputFolder {
 public:
  /// Makes it where there is none.  Throws Error (kOther) where that, or writing there, fails.
  explicit OutputFolder(const std::string& path);
  /// The same, and nothing is in it yet.  Throws Error (kUsage), too, where something is.
  static OutputFolder New(const std::string& path);

  std::string Of(const std::string& name) const { return (path_ / name).string(); }
  void Write(const std::string& name, std::string_view contents) const;

 private:
  std::filesystem::path path_;
};

}  // namespace graticule::apps
