#include "graticule/io/pose_sequence.hpp"

#include <cmath>
#include <cstring>
#include <unordered_set>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::string_view kMagic{"PGSEQ1\0\0", 8};

class Reader {
 public:
  Reader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  PoseSequence Read() {
    if (bytes_.substr(0, kMagic.size()) != kMagic)
      Fail("expected the beginning of a pose sequence, \"PGSEQ1\"");
    at_ = kMagic.size();
    sequence_.nodes = Count("the number of nodes", 1);
    sequence_.robots = Count("the number of robots", 1);
    if (sequence_.robots > sequence_.nodes) Fail("expected no more robots than nodes");
    const std::uint32_t graphs = Count("the number of graphs", 0);
    for (std::uint32_t g = 0; g < graphs; ++g) ReadGraph();
    if (at_ != bytes_.size()) Fail("expected the end after the last graph");
    return std::move(sequence_);
  }

 private:
  [[noreturn]] void Fail(const std::string& message) const {
    throw Error(name_ + ": byte " + std::to_string(at_) + ": " + message);
  }

  std::uint32_t Word(const char* what) {
    if (bytes_.size() - at_ < 4) Fail(std::string("the file ends within ") + what);
    std::uint32_t word = 0;
    for (unsigned i = 0; i < 4; ++i)
      word |= std::uint32_t{static_cast<unsigned char>(bytes_[at_ + i])} << (8 * i);
    return word;
  }

  std::uint32_t Count(const char* what, std::uint32_t least) {
    const std::uint32_t count = Word(what);
    if (count < least || count > INT32_MAX)
      Fail(std::string("expected ") + what + ", found " +
           std::to_string(static_cast<std::int32_t>(count)));
    at_ += 4;
    return count;
  }

  double Coordinate(const char* what) {
    const std::uint32_t word = Word(what);
    float number;
    std::memcpy(&number, &word, sizeof(number));
    if (!std::isfinite(number)) Fail(std::string("expected ") + what + ", found no finite number");
    at_ += 4;
    return number;
  }

  void ReadGraph() {
    const std::uint32_t present = Count("the number of nodes present", 0);
    const std::uint32_t count = Count("the number of poses", 0);
    for (std::uint32_t i = 0; i < count; ++i) {
      PoseSequence::Pose pose;
      pose.node = Word("a node");
      if (pose.node >= sequence_.nodes)
        Fail("expected a node below " + std::to_string(sequence_.nodes) + ", found " +
             std::to_string(pose.node));
      at_ += 4;
      pose.world_from_robot.x = Coordinate("the x of a node");
      pose.world_from_robot.y = Coordinate("the y of a node");
      pose.world_from_robot.yaw = Coordinate("the yaw of a node");
      seen_.insert(pose.node);
      sequence_.poses.push_back(pose);
    }
    if (present != seen_.size())
      Fail("the graph says that it has " + std::to_string(present) + " nodes, but poses of " +
           std::to_string(seen_.size()) + " came");
    sequence_.ends.push_back(sequence_.poses.size());
  }

  std::string_view bytes_;
  const std::string& name_;
  std::size_t at_ = 0;
  PoseSequence sequence_;
  // As large as what came, not as what the file only says will come.
  std::unordered_set<std::uint32_t> seen_;
};

}  // namespace

PoseSequence ParsePoseSequence(std::string_view bytes, const std::string& name) {
  return Reader(bytes, name).Read();
}

}  // namespace graticule
