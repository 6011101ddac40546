#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace graticule {

/// A graph seen from above, as plain data: what DrawGraph draws.
struct GraphPlot {
  struct Node {
    double x_m = 0, y_m = 0;
    std::uint32_t group = 0;  ///< position in `groups`
  };

  enum class EdgeKind {
    kOdometry,  ///< along a trajectory: drawn in its group's colour
    kLoop,      ///< a loop closure: coloured by its chi2 per residual
    kLandmark,  ///< pose to landmark: faint
  };

  struct Edge {
    std::uint32_t a = 0, b = 0;  ///< positions in `after`
    EdgeKind kind = EdgeKind::kOdometry;
    double chi2 = 0;  ///< at the end; nan: could not be evaluated, drawn as the worst
    int residuals = 0;
  };

  std::string title, subtitle;
  std::string before_label = "Before", after_label = "After";
  std::vector<std::string> groups;  ///< robots, or key families
  std::vector<Node> before;         ///< as `after`, or empty: then there is one panel
  std::vector<Node> after;
  std::vector<Edge> edges;
  std::vector<std::uint32_t> landmarks;  ///< the nodes that are landmarks: small marks
};

/// Draws the graph before and after, at one scale and in one window, with a legend, a scale bar in
/// metres and a colour bar for the loop closures; the worst closures lie on top.  The result is an
/// SVG document of a few MB at most: above 120,000 closures it draws the worst ones and an even
/// choice of the others, and says so.  Nodes that are not finite are left out.
///
/// Throws Error: an edge or landmark beyond `after`, or `before` of another size.
std::string DrawGraph(const GraphPlot& plot);

}  // namespace graticule
