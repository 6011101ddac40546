#pragma once

// Internal to the readers: factors whose information matrix is not positive definite.

#include <cstddef>
#include <string>
#include <vector>

#include "graticule/io/recording.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/noise.hpp"

namespace graticule {

/// Adds factors to a graph.  Those that are refused for their information matrix alone are added
/// with the nearest one that is positive definite, and counted; at the end of the file they are all
/// refused at once, or where the reader may repair them, recorded.  Factors with good noise cost
/// nothing but the call.
class InformationGuard {
 public:
  explicit InformationGuard(bool repair) : repair_(repair) {}

  /// `add` adds the factor with the noise that it is given, or throws Error.  Returns false where
  /// it took `Nearest()` instead of `noise`.
  template <class Add>
  bool Try(NoiseView noise, std::size_t offset, const Add& add) {
    try {
      add(noise);
      return true;
    } catch (const Error& error) {
      if (!Project(noise) || !Succeeds(add)) throw;
      Count(offset, error.what());
      return false;
    }
  }
  /// The matrix that was taken last.
  const std::vector<double>& Nearest() const { return nearest_; }
  /// One more factor with `Nearest()` instead of its own.
  void CountAgain() { ++count_; }

  bool IsEmpty() const { return count_ == 0; }
  bool MayRepair() const { return repair_; }
  std::size_t FirstOffset() const { return first_offset_; }
  /// Why the file is refused: of its first bad matrix, and of all.
  std::string Refusal(const Graph& graph) const;
  RepairedInformation Record(const Graph& graph, std::string first) const;
  /// The end of a file of lines: throws Error "name:line:column: ...", or records.
  void Finish(const TextReader& reader, Recording* recording) const;

 private:
  bool Project(NoiseView noise);
  template <class Add>
  bool Succeeds(const Add& add) const {
    try {
      add(NoiseView{NoiseKind::kInformation, nearest_});
      return true;
    } catch (const Error&) {
      return false;
    }
  }
  void Count(std::size_t offset, const char* why);

  bool repair_;
  std::size_t count_ = 0, first_offset_ = 0;
  double smallest_eigenvalue_ = 0, largest_change_ = 0;
  double eigenvalue_ = 0, change_ = 0;  // of the matrix at hand
  std::string first_;                   // what the graph said of the first
  std::vector<double> nearest_;
};

}  // namespace graticule
