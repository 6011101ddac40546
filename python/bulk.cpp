#include "bulk.hpp"

#include <algorithm>

namespace graticule::python {
namespace {

std::uint32_t Id(std::int64_t number, std::size_t count, const char* what) {
  if (number < 0 || static_cast<std::uint64_t>(number) >= count)
    throw Error("there is no " + std::string(what) + " " + std::to_string(number) +
                    ": the graph has " + std::to_string(count),
                ErrorKind::kUsage);
  return static_cast<std::uint32_t>(number);
}

// The variables of a family in the order of their numbers.
std::vector<VariableId> Family(const Values& values, const std::string& family) {
  std::vector<VariableId> ids;
  for (std::size_t i = 0; i < values.Count(); ++i)
    if (values.KeyOf(static_cast<VariableId>(i)).Family() == family)
      ids.push_back(static_cast<VariableId>(i));
  if (ids.empty())
    throw Error("there is no variable of the family '" + family + "'", ErrorKind::kUsage);
  std::sort(ids.begin(), ids.end(), [&](VariableId a, VariableId b) {
    return values.KeyOf(a).Number() < values.KeyOf(b).Number();
  });
  return ids;
}

// The noise of each factor of a batch: one for all, or from the rows of an array.
class NoiseRows {
 public:
  NoiseRows(const py::object& noise, py::ssize_t count) {
    if (noise.is_none()) return;
    if (!py::isinstance<Noise>(noise)) rows_ = Dense<double>::ensure(noise);
    PyErr_Clear();
    if (!rows_ || rows_.ndim() < 2) {
      rows_ = Dense<double>{py::reinterpret_steal<Dense<double>>(py::handle())};
      try {
        one_ = noise.cast<Noise>();
      } catch (const py::cast_error&) {
        throw Error("noise: expected a Noise, a number or an array of numbers, found " +
                        py::repr(noise).cast<std::string>(),
                    ErrorKind::kUsage);
      }
      return;
    }
    is_matrix_ = rows_.ndim() == 3;
    ExpectShape(rows_, is_matrix_ ? Shape{count, -1, rows_.shape(1)} : Shape{count, -1}, "noise");
  }

  NoiseView Row(py::ssize_t i) {
    if (!rows_) return one_.View();
    const auto size = static_cast<std::size_t>(rows_.shape(1));
    if (!is_matrix_) return {NoiseKind::kSigma, {rows_.data(i), size}};
    upper_.clear();
    const double* matrix = rows_.data(i);
    for (std::size_t r = 0; r < size; ++r)
      for (std::size_t c = r; c < size; ++c) {
        if (matrix[r * size + c] != matrix[c * size + r])
          throw Error("noise: matrix " + std::to_string(i) + " is not symmetric",
                      ErrorKind::kUsage);
        upper_.push_back(matrix[r * size + c]);
      }
    return {NoiseKind::kInformation, upper_};
  }

 private:
  Noise one_;
  Dense<double> rows_{py::reinterpret_steal<Dense<double>>(py::handle())};
  bool is_matrix_ = false;
  std::vector<double> upper_;
};

// An error of a row of an array, with the row's number before it.
template <class Add>
void AboutRow(py::ssize_t row, const Add& add) {
  try {
    add();
  } catch (const Error& error) {
    throw Error("row " + std::to_string(row) + ": " + error.what(), error.Kind());
  }
}

template <class Number, class Get>
py::array_t<Number> RowsOfFactors(const Graph& graph, const Integers& factors, const Get& get) {
  ExpectShape(factors, {-1}, "factors");
  const py::ssize_t count = factors.shape(0);
  py::ssize_t width = 0;
  std::vector<Number> numbers;
  for (py::ssize_t i = 0; i < count; ++i) {
    const auto row = get(Id(factors.at(i), graph.FactorCount(), "factor"));
    if (i == 0) width = static_cast<py::ssize_t>(row.size());
    if (static_cast<py::ssize_t>(row.size()) != width)
      throw Error("factors: they are not of one size", ErrorKind::kUsage);
    numbers.insert(numbers.end(), row.begin(), row.end());
  }
  return Owned(std::move(numbers), {count, width});
}

}  // namespace

Ids AddVariables(Graph& graph, const std::string& family, const std::string& type,
                 const Dense<double>& values, const std::optional<Integers>& numbers,
                 const std::optional<Dense<bool>>& fixed) {
  ExpectShape(values, {-1, -1}, "values");
  const py::ssize_t count = values.shape(0);
  const auto size = static_cast<std::size_t>(values.shape(1));
  if (numbers) ExpectShape(*numbers, {count}, "numbers");
  if (fixed) ExpectShape(*fixed, {count}, "fixed");
  const std::optional<std::uint64_t> largest = graph.LargestNumber(family);
  const std::uint64_t next = largest ? *largest + 1 : 0;
  if (!numbers && largest && ~*largest < static_cast<std::uint64_t>(count))
    throw Error("numbers: give them, for none is left above " + std::to_string(*largest),
                ErrorKind::kUsage);
  const Graph::TypeId type_id = graph.VariableTypeId(type);
  Ids ids(count);
  for (py::ssize_t i = 0; i < count; ++i)
    AboutRow(i, [&] {
      if (numbers && numbers->at(i) < 0)
        throw Error(
            "numbers: expected a number of 0 or more, found " + std::to_string(numbers->at(i)),
            ErrorKind::kUsage);
      const Key key(family, numbers ? static_cast<std::uint64_t>(numbers->at(i))
                                    : next + static_cast<std::uint64_t>(i));
      ids.mutable_at(i) = graph.Add(key, type_id, {values.data(i), size}, fixed && fixed->at(i));
    });
  return ids;
}

Ids AddFactors(Graph& graph, const std::string& type, const Integers& variables,
               const Dense<double>& measurements, const py::object& noise, const Loss& loss,
               const std::string& source) {
  ExpectShape(variables, {-1, -1}, "variables");
  const py::ssize_t count = variables.shape(0);
  ExpectShape(measurements, {count, -1}, "measurements");
  NoiseRows noises(noise, count);
  const Graph::TypeId type_id = graph.FactorTypeId(type);
  std::vector<VariableId> blocks(static_cast<std::size_t>(variables.shape(1)));
  Ids ids(count);
  for (py::ssize_t i = 0; i < count; ++i)
    AboutRow(i, [&] {
      for (std::size_t b = 0; b < blocks.size(); ++b)
        blocks[b] =
            Id(variables.at(i, static_cast<py::ssize_t>(b)), graph.VariableCount(), "variable");
      ids.mutable_at(i) = graph.Add(
          type_id, blocks, {measurements.data(i), static_cast<std::size_t>(measurements.shape(1))},
          noises.Row(i), loss, source);
    });
  return ids;
}

std::vector<Key> KeysOf(const Values& values) {
  std::vector<Key> keys;
  keys.reserve(values.Count());
  for (std::size_t i = 0; i < values.Count(); ++i)
    keys.push_back(values.KeyOf(static_cast<VariableId>(i)));
  return keys;
}

py::array_t<double> ArrayOfFamily(const Values& values, const std::string& family) {
  const std::vector<VariableId> ids = Family(values, family);
  const std::size_t size = values[ids[0]].size();
  std::vector<double> rows;
  rows.reserve(ids.size() * size);
  for (const VariableId id : ids) {
    const Span<const double> row = values[id];
    if (row.size() != size)
      throw Error("variables of the family '" + family + "' are not of one size",
                  ErrorKind::kUsage);
    rows.insert(rows.end(), row.begin(), row.end());
  }
  return Owned(std::move(rows),
               {static_cast<py::ssize_t>(ids.size()), static_cast<py::ssize_t>(size)});
}

py::array_t<std::uint64_t> NumbersOfFamily(const Values& values, const std::string& family) {
  std::vector<std::uint64_t> numbers;
  for (const VariableId id : Family(values, family)) numbers.push_back(values.KeyOf(id).Number());
  return Owned(std::move(numbers));
}

Ids IdsOf(const Graph& graph, const std::string& family, const Integers& numbers) {
  Ids ids(Shape(numbers.shape(), numbers.shape() + numbers.ndim()));
  for (py::ssize_t i = 0; i < numbers.size(); ++i) {
    const std::int64_t number = numbers.data()[i];
    if (number < 0)
      throw Error("numbers: expected a number of 0 or more, found " + std::to_string(number),
                  ErrorKind::kUsage);
    ids.mutable_data()[i] = graph.IdOf(Key(family, static_cast<std::uint64_t>(number)));
  }
  return ids;
}

Ids FactorIds(const Graph& graph, const std::optional<std::string>& type,
              const std::optional<std::string>& source) {
  std::vector<std::uint32_t> ids;
  for (std::size_t i = 0; i < graph.FactorCount(); ++i) {
    const FactorView factor = graph.FactorAt(static_cast<FactorId>(i));
    if ((!type || factor.type->name == *type) && (!source || factor.source == *source))
      ids.push_back(static_cast<FactorId>(i));
  }
  return Owned(std::move(ids));
}

Ids VariablesOfFactors(const Graph& graph, const Integers& factors) {
  return RowsOfFactors<std::uint32_t>(graph, factors,
                                      [&](FactorId id) { return graph.VariablesOf(id); });
}

py::array_t<double> MeasurementsOfFactors(const Graph& graph, const Integers& factors) {
  return RowsOfFactors<double>(graph, factors,
                               [&](FactorId id) { return graph.FactorAt(id).measurement; });
}

}  // namespace graticule::python
