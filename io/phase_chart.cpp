#include "graticule/io/phase_chart.hpp"

#include <algorithm>

#include "graticule/io/chart.hpp"

namespace graticule {
namespace {

struct Phase {
  const char* name;
  double (*seconds)(const Timing&);
};

// What no phase accounts for, where it is more than the timers' own noise.
double Other(const Timing& t) {
  const double rest =
      t.total.wall - t.load.wall - t.initialise.wall - t.build.wall - t.solve.wall - t.write.wall;
  return rest > 0.01 * t.total.wall ? rest : 0;
}

constexpr Phase kPhases[] = {
    {"load", [](const Timing& t) { return t.load.wall; }},
    {"initialise", [](const Timing& t) { return t.initialise.wall; }},
    {"build", [](const Timing& t) { return t.build.wall; }},
    {"preprocess", [](const Timing& t) { return t.preprocess; }},
    {"evaluate", [](const Timing& t) { return t.evaluate; }},
    {"linear solve", [](const Timing& t) { return t.linear_solve; }},
    {"rest of solve",
     [](const Timing& t) { return t.solve.wall - t.preprocess - t.evaluate - t.linear_solve; }},
    {"write", [](const Timing& t) { return t.write.wall; }},
    {"other", Other},
};

}  // namespace

std::string DrawPhases(const std::string& title,
                       const std::vector<std::pair<std::string, Timing>>& runs, double width_px) {
  BarChart chart;
  chart.title = title;
  chart.width = width_px;
  for (const auto& [name, timing] : runs) chart.bars.push_back({name, {}});
  for (const Phase& phase : kPhases) {
    const bool any = std::any_of(runs.begin(), runs.end(),
                                 [&](const auto& run) { return phase.seconds(run.second) > 0; });
    if (!any) continue;
    chart.parts.emplace_back(phase.name);
    for (std::size_t i = 0; i < runs.size(); ++i)
      chart.bars[i].seconds.push_back(phase.seconds(runs[i].second));
  }
  return DrawBars(chart);
}

}  // namespace graticule
