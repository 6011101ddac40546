#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "graticule/solver/graph.hpp"
#include "graticule/solver/marginals.hpp"

namespace graticule::apps {

/// Covariances that were asked for, ready to be printed; or why there are none.
struct MarginalsResult {
  struct Row {
    Key key;
    Fields tangent;
    std::vector<double> covariance;  ///< row-major
  };
  std::vector<Row> rows;
  std::vector<std::string> anchors;
  std::string diagnosis;  ///< not empty: the problem is ill-posed
  std::vector<Diagnosis::Loose> loose;
};

/// "pose:1,pose:2", or "all".  Throws Error (kUsage): not a key, or not in the graph.
std::vector<Key> ReadKeys(const std::string& text, const Graph& graph);

/// Of the graph with its own losses, as ComputeMarginals.
MarginalsResult FindMarginals(const Graph& graph, const Values& values,
                              const std::vector<Key>& keys);
nlohmann::ordered_json MarginalsJson(const MarginalsResult& result);
/// Standard deviations a key, and whole blocks where few were asked for.
void PrintMarginals(const MarginalsResult& result);

}  // namespace graticule::apps
