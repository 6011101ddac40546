#include "graticule/problems/attenuation/tune.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "graticule/io/file.hpp"
#include "graticule/io/text.hpp"
#include "graticule/problems/parallel_for.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr const char* kHeader = "graticule-compass-search 1";

using Known = std::map<std::vector<double>, double>;

/// The start and the steps: what makes a search the same one.
std::string Heading(const std::vector<double>& start, const CompassOptions& options) {
  std::string text = std::string(kHeader) + "\nsearch";
  const auto append = [&](const std::vector<double>& numbers) {
    text += " |";
    for (const double number : numbers) {
      text += ' ';
      AppendNumber(&text, number);
    }
  };
  append(start);
  append({options.first_step, options.last_step});
  append(options.scale);
  append(options.lower);
  append(options.upper);
  return text + "\n";
}

Known ReadState(const std::string& path, const std::string& heading, std::size_t size) {
  Known known;
  if (!std::filesystem::exists(path)) return known;
  const std::string text = ReadFile(path);
  if (text.compare(0, heading.size(), heading) != 0)
    throw Error(path + ": not the state of this search: other start, steps or bounds");
  TextReader reader(text, path);
  reader.Seek(heading.size());
  while (reader.NextLine()) {
    std::vector<double> point;
    for (std::size_t i = 0; i < size; ++i) point.push_back(reader.Double("a coordinate"));
    const double value = reader.Accept("inf") ? HUGE_VAL : reader.Double("the value");
    reader.ExpectEnd();
    known[point] = value;
  }
  return known;
}

void WriteState(const std::string& path, const std::string& heading, const Known& known) {
  std::string text = heading;
  for (const auto& [point, value] : known) {
    for (const double number : point) {
      AppendNumber(&text, number);
      text += ' ';
    }
    if (std::isfinite(value))
      AppendNumber(&text, value);
    else
      text += "inf";
    text += '\n';
  }
  WriteFile(path, text);
}

void Check(const std::vector<double>& start, const CompassOptions& options) {
  const auto fits = [&](const std::vector<double>& numbers) {
    return numbers.empty() || numbers.size() == start.size();
  };
  if (start.empty() || !fits(options.scale) || !fits(options.lower) || !fits(options.upper))
    throw Error("compass search: start, scale and bounds are of different sizes",
                ErrorKind::kUsage);
  if (!(options.last_step > 0) || !(options.first_step >= options.last_step) ||
      options.threads == 0)
    throw Error("compass search: steps above zero, the first not below the last, and a thread",
                ErrorKind::kUsage);
}

}  // namespace

CompassResult CompassSearch(const std::function<double(const std::vector<double>&)>& value,
                            const std::vector<double>& start, const CompassOptions& options) {
  Check(start, options);
  const std::string heading = Heading(start, options);
  Known known;
  if (!options.state_path.empty()) known = ReadState(options.state_path, heading, start.size());
  CompassResult result;

  const auto evaluate = [&](const std::vector<std::vector<double>>& points) {
    std::vector<std::vector<double>> fresh;
    for (const auto& point : points)
      if (known.find(point) == known.end() &&
          std::find(fresh.begin(), fresh.end(), point) == fresh.end())
        fresh.push_back(point);
    std::vector<double> values(fresh.size());
    ParallelFor(fresh.size(), options.threads, [&](std::size_t, std::size_t i) {
      const double found = value(fresh[i]);
      values[i] = std::isfinite(found) ? found : HUGE_VAL;
    });
    for (std::size_t i = 0; i < fresh.size(); ++i) known[fresh[i]] = values[i];
    result.evaluations += fresh.size();
    if (!fresh.empty() && !options.state_path.empty())
      WriteState(options.state_path, heading, known);
  };

  evaluate({start});
  result.best = start;
  result.value = result.start_value = known.at(start);
  for (double step = options.first_step; step >= options.last_step;) {
    if (result.evaluations >= options.max_evaluations) return result;
    std::vector<std::vector<double>> points;
    for (std::size_t i = 0; i < start.size(); ++i)
      for (const double sign : {1.0, -1.0}) {
        std::vector<double> point = result.best;
        point[i] += sign * step * (options.scale.empty() ? 1 : options.scale[i]);
        if (!options.lower.empty()) point[i] = std::max(point[i], options.lower[i]);
        if (!options.upper.empty()) point[i] = std::min(point[i], options.upper[i]);
        points.push_back(std::move(point));
      }
    evaluate(points);
    // All gains at once: of each coordinate the better way, where there is one.
    std::vector<double> together = result.best;
    int gains = 0;
    for (std::size_t i = 0; i < start.size(); ++i) {
      const auto &up = points[2 * i], &down = points[2 * i + 1];
      const auto& better = known.at(down) < known.at(up) ? down : up;
      if (!(known.at(better) < result.value)) continue;
      together[i] = better[i];
      ++gains;
    }
    if (gains > 1) {
      points.push_back(together);
      evaluate({together});
    }
    bool is_better = false;
    for (const auto& point : points)
      if (known.at(point) < result.value) {
        result.best = point;
        result.value = known.at(point);
        is_better = true;
      }
    if (!is_better) step /= 2;
  }
  result.has_converged = true;
  return result;
}

}  // namespace graticule
