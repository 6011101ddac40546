#include "graticule/io/information_guard.hpp"

#include <algorithm>

#include "graticule/solver/nearest_information.hpp"

namespace graticule {
namespace {

std::size_t CountInformation(const Graph& graph) {
  std::size_t count = 0;
  for (FactorId id = 0; id < graph.FactorCount(); ++id)
    count += graph.FactorAt(id).noise.kind == NoiseKind::kInformation;
  return count;
}

}  // namespace

std::string ToString(const RepairedInformation& repaired) {
  const bool one = repaired.count == 1;
  return std::to_string(repaired.count) + " of " + std::to_string(repaired.of) +
         " information matrices " + (one ? "was" : "were") + " not positive definite and " +
         (one ? "was" : "were") + " repaired: smallest eigenvalue " +
         Shown(repaired.smallest_eigenvalue) + ", largest relative change " +
         Shown(repaired.largest_change) + ", first at " + repaired.first;
}

bool InformationGuard::Project(NoiseView noise) {
  if (noise.kind != NoiseKind::kInformation) return false;
  std::size_t size = 0;
  while (size * (size + 1) / 2 < noise.values.size()) ++size;
  if (size * (size + 1) / 2 != noise.values.size()) return false;
  std::vector<double> nearest(noise.values.begin(), noise.values.end());
  const auto projection =
      ProjectInformation({nearest.data(), nearest.size()}, static_cast<int>(size));
  if (!projection) return false;
  nearest_ = std::move(nearest);
  eigenvalue_ = projection->smallest_eigenvalue;
  change_ = projection->change;
  return true;
}

void InformationGuard::Count(std::size_t offset, const char* why) {
  if (count_++ == 0) {
    first_offset_ = offset;
    first_ = why;
    smallest_eigenvalue_ = eigenvalue_;
  }
  smallest_eigenvalue_ = std::min(smallest_eigenvalue_, eigenvalue_);
  largest_change_ = std::max(largest_change_, change_);
}

std::string InformationGuard::Refusal(const Graph& graph) const {
  return first_ + " (" + std::to_string(count_) + " of " + std::to_string(CountInformation(graph)) +
         " in this file " + (count_ == 1 ? "is" : "are") + " not, smallest eigenvalue " +
         Shown(smallest_eigenvalue_) + "); --repair-information takes the nearest that are";
}

RepairedInformation InformationGuard::Record(const Graph& graph, std::string first) const {
  return {count_, CountInformation(graph), smallest_eigenvalue_, largest_change_, std::move(first)};
}

void InformationGuard::Finish(const TextReader& reader, Recording* recording) const {
  if (IsEmpty()) return;
  if (!repair_) reader.FailAt(first_offset_, Refusal(recording->graph));
  recording->repaired =
      Record(recording->graph,
             std::string(reader.Name()) + ":" + std::to_string(reader.LineNumber(first_offset_)));
}

}  // namespace graticule
