#include "graticule/problems/pose_graph/chordal.hpp"

#include "graticule/problems/pose_graph/relaxation.hpp"

namespace graticule {

ChordalReport PlaceByChordal(const Graph& graph, Values* values) {
  ChordalReport report;
  Relaxation<2> plane(graph, values);
  Relaxation<3> space(graph, values);
  plane.Run(&report);
  space.Run(&report);
  report.landmarks = PlaceLandmarks(graph, values);
  plane.WriteLandmarks(values);
  space.WriteLandmarks(values);
  return report;
}

}  // namespace graticule
