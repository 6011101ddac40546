#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace graticule {

/// A topic's messages of one publisher.
struct BagConnection {
  std::string topic;  ///< "/scan"
  std::string type;   ///< "sensor_msgs/LaserScan"
};

struct BagMessage {
  std::size_t connection = 0;  ///< into BagReader::Connections
  double stamp_s = 0;          ///< when it was recorded
  std::string_view data;       ///< as ROS serialises it; valid until the next message
};

/// Reads a recording of ROS 1 (bag format 2.0, http://wiki.ros.org/Bags/Format/2.0), message after
/// message as they were recorded, with chunks that are not packed, or by bz2 or lz4.  A few chunks'
/// memory, whatever the size of the file; the index is not needed.
///
/// Throws Error "path: ...": no bag, version 1, encrypted, cut short anywhere, damaged.
class BagReader {
 public:
  explicit BagReader(const std::string& path);
  /// The same of a file's contents.
  static BagReader OfContents(std::string contents, const std::string& name);

  BagReader(BagReader&&) noexcept;
  BagReader& operator=(BagReader&&) noexcept;
  ~BagReader();

  /// False at the end.
  bool Next(BagMessage* message);
  /// Those that were met so far; before a message its own.
  const std::vector<BagConnection>& Connections() const;
  const std::string& Path() const;

 private:
  class File;
  explicit BagReader(std::unique_ptr<File> file);
  std::unique_ptr<File> file_;
};

/// Everything that the bag has: "/scan (sensor_msgs/LaserScan), /tf (tf2_msgs/TFMessage)", by name;
/// reads the whole of it.
std::vector<BagConnection> BagTopics(const std::string& path);

/// Which topic of a type is meant: `wanted` where it is not empty, else `usual` where there is one
/// of that name, else the only one there is; "" where there is none and `wanted` is empty.  Throws
/// Error "path: ..." that lists the bag's topics: `wanted` is not there or of another type, there
/// are several.
std::string TopicOf(const std::string& path, const std::vector<BagConnection>& topics,
                    const std::vector<std::string>& types, const std::string& wanted,
                    const std::string& usual, const std::string& option);
/// "; it has /scan (sensor_msgs/LaserScan), ...".
std::string ListOf(const std::vector<BagConnection>& topics);

}  // namespace graticule
