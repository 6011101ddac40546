#include "graticule/problems/mapping/mission.hpp"

#include "graticule/solver/error.hpp"

namespace graticule {

Mission MissionFromG2o(Graph graph, G2oLaser laser, const std::string& name) {
  Mission mission{std::move(laser.log), std::move(graph), {}};
  for (std::size_t scan = 0; scan < laser.vertices.size(); ++scan) {
    const Key key("pose", laser.vertices[scan]);
    const VariableId variable = mission.graph.Find(key);
    if (variable == Layout::kNone || mission.graph.TypeOf(variable).name != "se2/1")
      throw Error(name + ": there is a scan of " + key.ToString() +
                  ", but no such pose of the plane");
    mission.nodes.push_back({variable, scan});
  }
  return mission;
}

}  // namespace graticule
