#pragma once

#include <string>
#include <vector>

#include "graticule/solver/graph.hpp"

namespace graticule {

/// How a graph hangs together, from its shape alone: no numbers are looked at.
struct Structure {
  struct Piece {
    std::size_t variables = 0;
    std::size_t factors = 0;
    VariableId first = 0;  ///< its smallest key
    /// The smallest key among its variables with the most degrees of freedom: what an anchor would
    /// hold.
    VariableId anchor = 0;
    bool has_fixed = false;     ///< a variable is fixed
    bool has_absolute = false;  ///< a factor depends on more than relative placement
    /// Nothing says where it is as a whole: its gauge is free.
    bool IsLoose() const { return !has_fixed && !has_absolute; }
  };
  std::vector<Piece> pieces;  ///< connected by factors, in the order of their first keys
  std::vector<VariableId>
      isolated;  ///< free variables without a factor, in key order; not in `pieces`
  /// Free variables with fewer residuals around them than they have degrees of freedom, in key
  /// order.
  std::vector<VariableId> starved;
};

/// O(variables + factors).
Structure AnalyseStructure(const Graph& graph);

/// The variables to hold fixed so that no piece's gauge is free.  Throws Error (kIllPosed): a
/// variable without a factor; or, unless `allow_pieces`, several pieces of which at least one is
/// loose.
std::vector<VariableId> ChooseAnchors(const Graph& graph, const Structure& structure,
                                      bool allow_pieces);

/// Why a problem has no single answer: which keys may move, along which fields, without any factor
/// minding.
struct Diagnosis {
  struct Loose {
    Key key;
    std::vector<std::string> fields;  ///< of its tangent: "x", "yaw"
    double share = 0;                 ///< of the free directions' squared length, over all keys 1
  };
  /// Independent directions in which nothing holds the problem; `at_least` if there may be more.
  std::size_t free_directions = 0;
  bool at_least = false;
  std::vector<Loose> loose;  ///< largest share first, ties by key
  std::string summary;       ///< one line for people
};

/// Looks for directions that no factor minds, at these values, with `anchors` held: the null space
/// of the whitened, column-scaled Jacobian, by inverse iteration on its normal matrix.  A direction
/// counts as free when its scaled norm is below 1e-8, the square root of double precision: beyond
/// that no solver built on normal equations can tell.  An empty diagnosis (free_directions 0): the
/// problem is well posed. Throws Error as Evaluation does, and kOther where a factor cannot be
/// evaluated.
Diagnosis Diagnose(const Graph& graph, const Values& values,
                   const std::vector<VariableId>& anchors);

}  // namespace graticule
