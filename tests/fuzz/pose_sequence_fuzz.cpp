#include "fuzz.hpp"
#include "graticule/io/pose_sequence.hpp"

GRATICULE_FUZZ(bytes) {
  using namespace graticule;
  const PoseSequence sequence = ParsePoseSequence(bytes, "fuzz.pgseq");
  for (std::size_t g = 0; g < sequence.GraphCount(); ++g)
    for (const PoseSequence::Pose& pose : sequence.Graph(g))
      if (sequence.RobotOf(pose.node) >= sequence.robots) std::abort();
}
