#pragma once

#include <stdlib.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace graticule {

/// A folder in memory, for readers that take a path; it goes when the process ends.
class MemoryFolder {
 public:
  MemoryFolder() {
    if (!::mkdtemp(path_.data())) std::abort();
  }
  ~MemoryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  MemoryFolder(const MemoryFolder&) = delete;
  MemoryFolder& operator=(const MemoryFolder&) = delete;

  std::string operator/(const char* name) const { return path_ + "/" + name; }

 private:
  std::string path_ = "/dev/shm/graticule-fuzz-XXXXXX";
};

}  // namespace graticule
