#include "output_folder.hpp"

#include "graticule/io/file.hpp"
#include "problem.hpp"

namespace graticule::apps {

OutputFolder::OutputFolder(const std::string& path) : path_(path) {
  std::error_code error;
  std::filesystem::create_directories(path_, error);
  if (!std::filesystem::is_directory(path_))
    throw Error(path + ": the folder cannot be made" + (error ? ": " + error.message() : ""),
                ErrorKind::kOther);
  ExpectWritable(Of("map.yaml"));
}

OutputFolder OutputFolder::New(const std::string& path) {
  std::error_code error;
  if (std::filesystem::exists(path, error) &&
      !(std::filesystem::is_directory(path, error) && std::filesystem::is_empty(path, error)))
    throw Error(path + ": is there already, and is no empty folder", ErrorKind::kUsage);
  return OutputFolder(path);
}

void OutputFolder::Write(const std::string& name, std::string_view contents) const {
  WriteFile(Of(name), contents);
}

}  // namespace graticule::apps
