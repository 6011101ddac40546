#include "graticule/problems/attenuation/tune.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>

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
  if (!options.state_of.empty()) text += "\nof " + options.state_of;
  return text + "\n";
}

Known ReadState(const std::string& path, const std::string& heading, std::size_t size) {
  Known known;
  if (!std::filesystem::exists(path)) return known;
  const std::string text = ReadFile(path);
  if (text.compare(0, heading.size(), heading) != 0)
    throw Error(path +
                ": the state of another search: other data, options, start, steps or bounds; "
                "remove it to begin anew");
  if (text.back() != '\n') throw Error(path + ": cut short");
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
  std::mutex one_at_a_time;
  const CompassEvaluate evaluate = [&](const std::vector<std::vector<double>>& points,
                                       const CompassFound& found) {
    ParallelFor(points.size(), options.threads, [&](std::size_t, std::size_t i) {
      const double at_point = value(points[i]);
      const std::lock_guard<std::mutex> lock(one_at_a_time);
      found(i, at_point);
    });
  };
  return CompassSearch(evaluate, start, options);
}

CompassResult CompassSearch(const CompassEvaluate& find_values, const std::vector<double>& start,
                            const CompassOptions& options) {
  Check(start, options);
  const std::string heading = Heading(start, options);
  Known known;
  if (!options.state_path.empty()) known = ReadState(options.state_path, heading, start.size());
  CompassResult result;
  result.value = result.start_value = std::nan("");
  std::set<std::vector<double>> asked;  // for: a search that goes on ends where it would have ended

  const auto evaluate = [&](const std::vector<std::vector<double>>& points) {
    std::vector<std::vector<double>> fresh;
    for (const auto& point : points)
      if (asked.insert(point).second && known.find(point) == known.end()) fresh.push_back(point);
    if (fresh.empty()) return;
    find_values(fresh, [&](std::size_t i, double found) {
      known[fresh[i]] = std::isfinite(found) ? found : HUGE_VAL;
      ++result.evaluations;
      if (!options.state_path.empty()) WriteState(options.state_path, heading, known);
    });
  };
  // Infinite where it was stopped before that was found.
  const auto value_of = [&](const std::vector<double>& point) {
    const auto found = known.find(point);
    return found == known.end() ? HUGE_VAL : found->second;
  };
  // Takes the least of those that were found; whether there is one below the best.
  const auto take_least = [&](const std::vector<std::vector<double>>& points) {
    bool is_better = false;
    for (const auto& point : points) {
      const auto found = known.find(point);
      if (found == known.end()) {
        result.was_stopped = true;
      } else if (found->second < result.value) {
        result.best = point;
        result.value = found->second;
        is_better = true;
      }
    }
    return is_better;
  };

  result.best = start;
  evaluate({start});
  if (known.find(start) == known.end()) {
    result.was_stopped = true;
    return result;
  }
  result.value = result.start_value = known.at(start);
  for (double step = options.first_step; step >= options.last_step;) {
    std::vector<std::vector<double>> points;
    for (std::size_t i = 0; i < start.size(); ++i)
      for (const double sign : {1.0, -1.0}) {
        std::vector<double> point = result.best;
        point[i] += sign * step * (options.scale.empty() ? 1 : options.scale[i]);
        if (!options.lower.empty()) point[i] = std::max(point[i], options.lower[i]);
        if (!options.upper.empty()) point[i] = std::min(point[i], options.upper[i]);
        points.push_back(std::move(point));
      }
    const std::set<std::vector<double>> round(points.begin(), points.end());
    const auto news = static_cast<std::size_t>(std::count_if(
        round.begin(), round.end(), [&](const auto& point) { return asked.count(point) == 0; }));
    if (asked.size() + news > options.max_evaluations) return result;
    evaluate(points);
    // All gains at once: of each coordinate the better way, where there is one.
    std::vector<double> together = result.best;
    int gains = 0;
    for (std::size_t i = 0; i < start.size(); ++i) {
      const auto &up = points[2 * i], &down = points[2 * i + 1];
      const auto& better = value_of(down) < value_of(up) ? down : up;
      if (!(value_of(better) < result.value)) continue;
      together[i] = better[i];
      ++gains;
    }
    bool is_better = take_least(points);
    if (result.was_stopped) return result;
    if (gains > 1) {
      if (asked.count(together) == 0 && asked.size() >= options.max_evaluations) return result;
      evaluate({together});
      is_better = take_least({together}) || is_better;
      if (result.was_stopped) return result;
    }
    if (!is_better) step /= 2;
  }
  result.has_converged = true;
  return result;
}

}  // namespace graticule
