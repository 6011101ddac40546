#include "arrays.hpp"

namespace graticule::python {

namespace {

std::string Text(const py::ssize_t* sizes, std::size_t count) {
  std::string text = "(";
  for (std::size_t i = 0; i < count; ++i)
    text += (i ? ", " : "") + (sizes[i] < 0 ? std::string("any") : std::to_string(sizes[i]));
  return text + (count == 1 ? ",)" : ")");
}

}  // namespace

Integers::Integers(const py::array& array) : Dense<std::int64_t>(array) {
  const char kind = array.dtype().kind();
  if (array.size() > 0 && kind != 'i' && kind != 'u')
    throw Error(
        "expected an array of integers, found one of " + py::str(array.dtype()).cast<std::string>(),
        ErrorKind::kUsage);
}

std::string ShapeOf(const py::array& array) {
  return Text(array.shape(), static_cast<std::size_t>(array.ndim()));
}

void ExpectShape(const py::array& array, const Shape& shape, const char* what) {
  bool fits = static_cast<std::size_t>(array.ndim()) == shape.size();
  for (std::size_t i = 0; fits && i < shape.size(); ++i)
    fits = shape[i] < 0 || array.shape(static_cast<py::ssize_t>(i)) == shape[i];
  if (!fits)
    throw Error(std::string(what) + ": expected an array of shape " +
                    Text(shape.data(), shape.size()) + ", found " + ShapeOf(array),
                ErrorKind::kUsage);
}

}  // namespace graticule::python
