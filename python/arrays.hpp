#pragma once

// How numbers cross: numpy on one side, vectors, arrays and Eigen's small vectors on the other.
//
// - What a function returns by value becomes an array that owns the vector's own memory: no copy.
// - What a field of an object is becomes a copy that cannot be written to, so that nobody believes
//   to have changed the object.
// - What C++ takes by value or by reference to const is copied once, from any sequence of numbers.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "graticule/io/planar_pose.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/span.hpp"

namespace graticule::python {

namespace py = pybind11;

/// Any numbers, as C++ wants them: one after the other, the last index fastest.
template <class T>
using Dense = py::array_t<T, py::array::c_style | py::array::forcecast>;
using Shape = std::vector<py::ssize_t>;

/// Ids and numbers of keys.  Unlike Dense, takes no array of others: 1.7 is not the id 1, and a
/// mask is not a list of ids.  An empty one may be of any kind, as Python's [] is.
class Integers : public Dense<std::int64_t> {
 public:
  Integers() = default;
  /// Throws Error (kUsage).
  explicit Integers(const py::array& array);
};

/// An array that owns what was in the vector.
template <class T>
py::array_t<T> Owned(std::vector<T>&& values, Shape shape) {
  auto* kept = new std::vector<T>(std::move(values));
  const py::capsule owner(kept, [](void* vector) { delete static_cast<std::vector<T>*>(vector); });
  return py::array_t<T>(std::move(shape), kept->data(), owner);
}
template <class T>
py::array_t<T> Owned(std::vector<T>&& values) {
  const auto size = static_cast<py::ssize_t>(values.size());
  return Owned(std::move(values), Shape{size});
}

inline void Freeze(const py::array& array) {
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
}

/// An array of memory that belongs to `owner`, which lives as long as the array does.
template <class T>
py::array_t<T> View(const T* data, Shape shape, py::handle owner, bool writeable) {
  py::array_t<T> view(std::move(shape), data, owner);
  if (!writeable) Freeze(view);
  return view;
}

/// A copy that cannot be written to.
template <class T>
py::array_t<T> Frozen(const T* data, Shape shape) {
  py::array_t<T> copy(std::move(shape), data);
  Freeze(copy);
  return copy;
}

/// "(4, 3)"
std::string ShapeOf(const py::array& array);
/// Throws Error (kUsage) unless the array has this shape; -1: any length.
void ExpectShape(const py::array& array, const Shape& shape, const char* what);

}  // namespace graticule::python

namespace pybind11::detail {

/// Casters for what is a row of numbers in C++.
template <class Container, class T, bool kIsVector>
struct numbers_caster {
  PYBIND11_TYPE_CASTER(Container, const_name("numpy.ndarray[") + npy_format_descriptor<T>::name +
                                      const_name("]"));

  bool load(handle source, bool convert) {
    if (isinstance<str>(source) || isinstance<bytes>(source)) return false;
    if (!convert && !array_t<T>::check_(source)) return false;
    const auto array = graticule::python::Dense<T>::ensure(source);
    if (!array) {
      PyErr_Clear();
      return false;
    }
    if (array.ndim() != 1) return false;
    const auto size = static_cast<std::size_t>(array.size());
    if constexpr (kIsVector) {
      value.assign(array.data(), array.data() + size);
    } else {
      if (size != static_cast<std::size_t>(value.size())) return false;
      std::copy(array.data(), array.data() + size, value.data());
    }
    return true;
  }

  template <class Source>
  static handle cast(Source&& source, return_value_policy, handle) {
    if constexpr (kIsVector && !std::is_lvalue_reference_v<Source> && !std::is_const_v<Source>) {
      return graticule::python::Owned(std::move(source)).release();
    } else {
      return graticule::python::Frozen(source.data(), {static_cast<ssize_t>(source.size())})
          .release();
    }
  }
};

template <>
struct type_caster<graticule::python::Integers> {
  PYBIND11_TYPE_CASTER(graticule::python::Integers, const_name("numpy.ndarray[") +
                                                        npy_format_descriptor<std::int64_t>::name +
                                                        const_name("]"));

  bool load(handle source, bool) {
    const array given = array::ensure(source);
    if (!given) {
      PyErr_Clear();
      return false;
    }
    value = graticule::python::Integers(given);
    return true;
  }
};
template <>
struct type_caster<std::vector<double>> : numbers_caster<std::vector<double>, double, true> {};
template <>
struct type_caster<std::vector<float>> : numbers_caster<std::vector<float>, float, true> {};
template <>
struct type_caster<std::vector<std::uint8_t>>
    : numbers_caster<std::vector<std::uint8_t>, std::uint8_t, true> {};
template <>
struct type_caster<std::vector<std::uint32_t>>
    : numbers_caster<std::vector<std::uint32_t>, std::uint32_t, true> {};
template <>
struct type_caster<std::vector<std::size_t>>
    : numbers_caster<std::vector<std::size_t>, std::size_t, true> {};
template <std::size_t kSize>
struct type_caster<std::array<double, kSize>>
    : numbers_caster<std::array<double, kSize>, double, false> {};
template <>
struct type_caster<Eigen::Vector2d> : numbers_caster<Eigen::Vector2d, double, false> {};
template <>
struct type_caster<Eigen::Vector3d> : numbers_caster<Eigen::Vector3d, double, false> {};

/// [x m, y m, yaw rad]
template <>
struct type_caster<graticule::PlanarPose> {
  PYBIND11_TYPE_CASTER(graticule::PlanarPose, const_name("numpy.ndarray[numpy.float64]"));

  bool load(handle source, bool convert) {
    make_caster<std::array<double, 3>> numbers;
    if (!numbers.load(source, convert)) return false;
    const auto& [x, y, yaw] = cast_op<std::array<double, 3>&>(numbers);
    value = {x, y, yaw};
    return true;
  }
  static handle cast(const graticule::PlanarPose& pose, return_value_policy, handle) {
    const double numbers[] = {pose.x, pose.y, pose.yaw};
    return graticule::python::Frozen(numbers, {3}).release();
  }
};

}  // namespace pybind11::detail
