#pragma once

#include <cstdint>
#include <vector>

#include "graticule/solver/graph.hpp"

namespace graticule {

/// How false loop closures come about (after Suenderhauf and Protzel: Switchable constraints for
/// robust pose graph SLAM, 2012, who tell the same kinds apart).
enum class Corruption : std::uint8_t {
  kRandom,   ///< one by one, between any two poses: a place that looks like another
  kGrouped,  ///< runs of ten, from pose to pose beside each other: two corridors that look alike.
             ///< Within a run they agree with each other and with the odometry
  kLocal,    ///< between poses at most 20 apart by number
};

struct CorruptOptions {
  /// Of all closures afterwards, the share that was added here, in [0, 1).
  double fraction = 0.3;
  Corruption kind = Corruption::kRandom;
  std::uint64_t seed = 1;
};

struct Corrupted {
  Graph graph;
  std::vector<FactorId> outliers;  ///< the last factors; the graph itself does not say
};

/// The graph with false loop closures added; what was there stays, so that its optimum is the
/// truth to compare with.  A closure, as the suspects of ChooseSuspects, joins two poses.  Each
/// false one takes after a true one drawn at random: its measurement, noise, source and the
/// families that it joins, so that neither size nor name tells them apart; but other poses.  That
/// it is wrong is likely, not certain: two poses may be as it says by chance.
///
/// Same graph and options, same digits.  Throws Error (kUsage): a fraction outside [0, 1), a graph
/// without closures, or with too few poses for the kind.
Corrupted AddFalseClosures(const Graph& graph, const CorruptOptions& options = {});

}  // namespace graticule
