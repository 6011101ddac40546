#include "record.hpp"

#include "graticule/solver/nearest.hpp"

namespace graticule::python {

namespace {

std::string ClassName(const py::object& record) {
  return py::str(py::type::of(record).attr("__name__"));
}

}  // namespace

void NameField(const py::object& record_class, const char* name) {
  record_class.attr("_fields").cast<py::list>().append(name);
}

void SetFields(const py::object& record, const py::dict& fields) {
  if (fields.empty()) return;
  const auto names = record.attr("_fields").cast<std::vector<std::string>>();
  const std::vector<std::string_view> views(names.begin(), names.end());
  for (const auto& [key, value] : fields) {
    const auto name = key.cast<std::string>();
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw Error(ClassName(record) + " has no '" + name + "'" + DidYouMean(name, views),
                  ErrorKind::kUsage);
    if (py::type::of(record).attr(py::str(name)).attr("fset").is_none())
      throw Error(ClassName(record) + "." + name + " is a result: it is read, not set",
                  ErrorKind::kUsage);
    py::setattr(record, key, value);
  }
}

std::string ShowFields(const py::object& record) {
  constexpr std::size_t kLongest = 70;
  std::string text = ClassName(record) + "(";
  bool is_first = true;
  for (const py::handle& name : record.attr("_fields")) {
    std::string value = py::repr(record.attr(py::str(name)));
    if (value.size() > kLongest) value = value.substr(0, kLongest - 3) + "...";
    text += (is_first ? "" : ", ") + name.cast<std::string>() + "=" + value;
    is_first = false;
  }
  return text + ")";
}

py::dict FieldsOf(const py::object& record) {
  py::dict fields;
  for (const py::handle& name : record.attr("_fields")) fields[name] = record.attr(py::str(name));
  return fields;
}

std::string OptionText(const std::string& name, const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  // numpy's numbers as well
  if (PyIndex_Check(value.ptr()))
    return py::str(py::int_(py::reinterpret_borrow<py::object>(value)));
  if (PyNumber_Check(value.ptr()))
    return py::repr(py::float_(py::reinterpret_borrow<py::object>(value)));
  throw Error("option " + name + ": expected a text, a number or a truth value, found " +
                  py::repr(value).cast<std::string>(),
              ErrorKind::kUsage);
}

}  // namespace graticule::python
