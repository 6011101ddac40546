#pragma once

// clang-format off
// The only header a plug-in author needs (docs/plugins.md is the guide).
//
//   /// Distance from the radar to the target.  Residual [m]; zero when they agree.
//   struct RadarRange {
//     static constexpr const char* kName = "radar_range/1";
//     static constexpr const char* kSchema = "radar:se2/1 target:point2/1 | range:m";
//     static constexpr const char* kSummary = "distance from the radar to the target";
//
//     double range_m;
//     explicit RadarRange(graticule::Measurement m) : range_m(m[0]) {}  // throws std::exception to refuse
//
//     template <class T>
//     bool operator()(const T* radar, const T* target, T* residual) const { ...; return true; }
//   };
//   GRATICULE_PLUGIN("radar", "1.0.0", "MIT", RadarRange)
//
// Options of such a struct:
// - `static constexpr bool kRelative = true;`: the residual depends on relative placement only.
// - analytic derivatives: instead of operator(), a member
//       bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const
//   with `jacobians` as in Ceres (row-major, null where not wanted), with respect to the stored fields, or
//   with `static constexpr bool kTangentJacobians = true;` to the tangent.
// - a block type that is not built in: `static constexpr int kBlockSizes[] = {3, 2};`, the stored sizes.
// - a block or measurement with `*` in the schema: use Evaluate; the constructor may take (Measurement, int
//   blocks), and a member `int ResidualSize() const` may give the residual's size.
//
// A struct with `kFields` instead of `kSchema` is a variable type: kName, kFields, kTangent, kSummary, and
// static functions Plus, PlusJacobian, Minus and, where not every stored value is legal, Normalise, as
// graticule_variable_type_v1 has them.  They never throw.  Without Plus it is a vector.
// clang-format on

#include <ceres/jet.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string_view>
#include <type_traits>
#include <utility>

#include "graticule/solver/plugin_abi.h"

namespace graticule {

/// The measured numbers of one factor, as its schema lays them out.
struct Measurement {
  const double* values;
  int size;
  double operator[](int i) const { return values[i]; }
};

// Hidden: two plug-ins with a struct of the same name must not share a table (GNU unique symbols
// would).
#pragma GCC visibility push(hidden)
namespace sdk {

/// Stored size of a built-in variable type, or -1.
constexpr int BlockSize(std::string_view type) {
  if (type == "se2/1") return 3;
  if (type == "so3/1") return 4;
  if (type == "se3/1") return 7;
  if (type == "point2/1") return 2;
  if (type == "point3/1") return 3;
  if (type == "bal_camera/1") return 9;
  constexpr std::string_view kVector = "vector";
  if (type.size() < 9 || type.substr(0, 6) != kVector || type.substr(type.size() - 2) != "/1")
    return -1;
  int n = 0;
  for (const char c : type.substr(6, type.size() - 8)) {
    if (c < '0' || c > '9') return -1;
    n = 10 * n + (c - '0');
  }
  return n;
}

/// Words in part number `part` of a schema (parts are separated by '|').  The schema's residual
/// is part 2, or part 1 where there is no part 2.
constexpr std::string_view SchemaPart(std::string_view schema, int part) {
  for (; part > 0; --part) {
    const std::size_t bar = schema.find('|');
    if (bar == std::string_view::npos) return {};
    schema = schema.substr(bar + 1);
  }
  return schema.substr(0, schema.find('|'));
}

constexpr int CountWords(std::string_view text) {
  int words = 0;
  bool in_word = false;
  for (const char c : text) {
    if (c != ' ' && !in_word) ++words;
    in_word = c != ' ';
  }
  return words;
}

constexpr std::string_view Word(std::string_view text, int index) {
  for (;;) {
    while (!text.empty() && text[0] == ' ') text.remove_prefix(1);
    const std::size_t end = text.find(' ');
    if (index-- == 0) return text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end);
  }
}

constexpr bool HasPart(std::string_view schema, int part) {
  for (const char c : schema) part -= c == '|';
  return part <= 0;
}

template <class F>
constexpr int ResidualSize() {
  return CountWords(SchemaPart(F::kSchema, HasPart(F::kSchema, 2) ? 2 : 1));
}

template <class F>
constexpr int BlockCount() {
  return CountWords(SchemaPart(F::kSchema, 0));
}

// Members that a factor may or may not have.
template <class F, class = void>
struct Sizes {
  static constexpr int Of(int block) {
    const std::string_view word = Word(SchemaPart(F::kSchema, 0), block);
    return BlockSize(word.substr(word.find(':') + 1));
  }
};
template <class F>
struct Sizes<F, std::void_t<decltype(F::kBlockSizes)>> {
  static constexpr int Of(int block) { return F::kBlockSizes[block]; }
};

template <class F, class = void>
struct IsRelative : std::false_type {};
template <class F>
struct IsRelative<F, std::void_t<decltype(F::kRelative)>> : std::bool_constant<F::kRelative> {};

template <class F, class = void>
struct HasTangentJacobians : std::false_type {};
template <class F>
struct HasTangentJacobians<F, std::void_t<decltype(F::kTangentJacobians)>>
    : std::bool_constant<F::kTangentJacobians> {};

template <class F, class = void>
struct HasEvaluate : std::false_type {};
template <class F>
struct HasEvaluate<F, std::void_t<decltype(std::declval<const F&>().Evaluate(
                          std::declval<const double* const*>(), std::declval<double*>(),
                          std::declval<double**>()))>> : std::true_type {};

template <class F, class = void>
struct HasResidualSize : std::false_type {};
template <class F>
struct HasResidualSize<F, std::void_t<decltype(std::declval<const F&>().ResidualSize())>>
    : std::true_type {};

inline void Say(graticule_error* error, const char* what) {
  if (error) std::snprintf(error->message, sizeof(error->message), "%s", what);
}

/// Calls a functor over Jets: all blocks' derivatives in one pass.
template <class F, std::size_t... kBlock>
bool EvaluateWithJets(const F& factor, const double* const* blocks, double* residual,
                      double** jacobians, std::index_sequence<kBlock...>) {
  constexpr int kSizes[] = {Sizes<F>::Of(static_cast<int>(kBlock))...};
  static_assert(((Sizes<F>::Of(static_cast<int>(kBlock)) > 0) && ...),
                "a block type of kSchema is not built in: add kBlockSizes");
  constexpr int kResiduals = ResidualSize<F>();
  if (jacobians == nullptr) return factor(blocks[kBlock]..., residual);

  constexpr int kTotal = (Sizes<F>::Of(static_cast<int>(kBlock)) + ...);
  using Jet = ceres::Jet<double, kTotal>;
  constexpr int kCount = sizeof...(kBlock);
  std::array<Jet, kTotal> x;
  std::array<const Jet*, kCount> first{};
  int offset = 0;
  for (int b = 0; b < kCount; ++b) {
    first[static_cast<std::size_t>(b)] = x.data() + offset;
    for (int i = 0; i < kSizes[b]; ++i, ++offset)
      x[static_cast<std::size_t>(offset)] = Jet(blocks[b][i], offset);
  }
  std::array<Jet, kResiduals> r;
  if (!factor(first[kBlock]..., r.data())) return false;
  offset = 0;
  for (int b = 0; b < kCount; ++b) {
    for (int row = 0; jacobians[b] && row < kResiduals; ++row)
      for (int i = 0; i < kSizes[b]; ++i)
        jacobians[b][row * kSizes[b] + i] = r[static_cast<std::size_t>(row)].v[offset + i];
    offset += kSizes[b];
  }
  for (int row = 0; row < kResiduals; ++row) residual[row] = r[static_cast<std::size_t>(row)].a;
  return true;
}

/// A struct as a C table.  No exception leaves it.
template <class F>
struct Table {
  static void* Create(const graticule_measurement* measurement, int32_t block_count,
                      int32_t* residual_count, graticule_error* error) {
    try {
      const Measurement m{measurement->values, measurement->value_count};
      F* factor = nullptr;
      if constexpr (std::is_constructible_v<F, Measurement, int>) {
        factor = new F(m, static_cast<int>(block_count));
      } else {
        (void)block_count;
        factor = new F(m);
      }
      if constexpr (HasResidualSize<F>::value) {
        *residual_count = factor->ResidualSize();
      } else {
        *residual_count = ResidualSize<F>();
      }
      return factor;
    } catch (const std::exception& exception) {
      Say(error, exception.what());
    } catch (...) {
      Say(error, "threw something that is not a std::exception");
    }
    return nullptr;
  }

  static int32_t Evaluate(const void* self, const double* const* blocks, double* residual,
                          double** jacobians, graticule_error* error) {
    try {
      const F& factor = *static_cast<const F*>(self);
      if constexpr (HasEvaluate<F>::value) {
        return factor.Evaluate(blocks, residual, jacobians);
      } else {
        return EvaluateWithJets(
            factor, blocks, residual, jacobians,
            std::make_index_sequence<static_cast<std::size_t>(BlockCount<F>())>());
      }
    } catch (const std::exception& exception) {
      Say(error, exception.what());
    } catch (...) {
      Say(error, "threw something that is not a std::exception");
    }
    return 0;
  }

  static void Destroy(void* self) { delete static_cast<F*>(self); }

  static constexpr graticule_factor_type_v1 kTable = {
      sizeof(graticule_factor_type_v1),
      (IsRelative<F>::value ? GRATICULE_FACTOR_RELATIVE : 0u) |
          (HasTangentJacobians<F>::value ? GRATICULE_FACTOR_TANGENT_JACOBIANS : 0u),
      F::kName,
      F::kSchema,
      F::kSummary,
      Create,
      Evaluate,
      Destroy};
};

template <class V, class = void>
struct IsVariable : std::false_type {};
template <class V>
struct IsVariable<V, std::void_t<decltype(V::kFields)>> : std::true_type {};

template <class V, class = void>
struct HasPlus : std::false_type {};
template <class V>
struct HasPlus<V, std::void_t<decltype(&V::Plus)>> : std::true_type {};

template <class V, class = void>
struct HasNormalise : std::false_type {};
template <class V>
struct HasNormalise<V, std::void_t<decltype(&V::Normalise)>> : std::true_type {};

/// A variable type as a C table.
template <class V>
struct VariableTable {
  static int32_t Normalise(double* x) {
    if constexpr (HasNormalise<V>::value) return V::Normalise(x);
    return 1;
  }

  static constexpr graticule_variable_type_v1 Make() {
    graticule_variable_type_v1 table = {sizeof(graticule_variable_type_v1),
                                        0,
                                        V::kName,
                                        V::kFields,
                                        V::kTangent,
                                        V::kSummary,
                                        nullptr,
                                        nullptr,
                                        nullptr,
                                        nullptr};
    if constexpr (HasPlus<V>::value) {
      table.plus = V::Plus;
      table.plus_jacobian = V::PlusJacobian;
      table.minus = V::Minus;
      table.normalise = Normalise;
    }
    return table;
  }

  static constexpr graticule_variable_type_v1 kTable = Make();
};

/// The tables of a plug-in's structs, in their order.
template <class... Types>
struct Tables {
  const graticule_factor_type_v1* factors[sizeof...(Types)] = {};
  const graticule_variable_type_v1* variables[sizeof...(Types)] = {};
  int32_t factor_count = 0, variable_count = 0;

  Tables() { (Add<Types>(), ...); }

  template <class Type>
  void Add() {
    if constexpr (IsVariable<Type>::value) {
      variables[variable_count++] = &VariableTable<Type>::kTable;
    } else {
      factors[factor_count++] = &Table<Type>::kTable;
    }
  }
};

template <class... Types>
const graticule_plugin_v1* Plugin(const char* name, const char* version, const char* licence) {
  static const Tables<Types...> tables;
  static const graticule_plugin_v1 plugin = {
      sizeof(graticule_plugin_v1), GRATICULE_ABI_VERSION, name,           version,         licence,
      tables.factor_count,         tables.variable_count, tables.factors, tables.variables};
  return &plugin;
}

}  // namespace sdk
#pragma GCC visibility pop
}  // namespace graticule

/// The one line that makes a shared library a plug-in: name, version, licence, structs of factors
/// and of variables.
#define GRATICULE_PLUGIN(name, version, licence, ...)                          \
  extern "C" __attribute__((visibility("default"))) const graticule_plugin_v1* \
  graticule_plugin_entry_v1() {                                                \
    return graticule::sdk::Plugin<__VA_ARGS__>(name, version, licence);        \
  }
