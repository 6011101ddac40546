#pragma once

#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "graticule/solver/option.hpp"

namespace graticule::python {

/// Sets attributes by name.  Throws Error (kUsage): one that is not among the class' fields, with
/// the nearest one.
void SetFields(const py::object& record, const py::dict& fields);
/// "LaserGeometry(first_angle=-1.57, step=0.0174)"; long values are cut short.
std::string ShowFields(const py::object& record);
/// The fields by name.
py::dict FieldsOf(const py::object& record);
/// True, 3, 1e-9 or "huber" as options' texts have them.  Throws Error (kUsage): anything else.
std::string OptionText(const std::string& name, const py::handle& value);
/// Documents a field among the class' own: what SetFields, ShowFields and pickling go by.
void NameField(const py::object& record_class, const char* name);

/// A struct of plain members as a Python class: keywords set its fields, repr shows them, it can be
/// copied and pickled.
template <class T>
class Record {
 public:
  Record(py::module_& module, const char* name, const char* doc) : class_(module, name, doc) {
    class_.attr("_fields") = py::list();
    if constexpr (std::is_default_constructible_v<T>) {
      class_.def(py::init([](const py::kwargs& fields) { return Made(fields); }),
                 "Fields that are not named keep their defaults.");
      class_.def(py::pickle([](const py::object& self) { return FieldsOf(self); },
                            [](const py::dict& fields) { return Made(fields); }));
    }
    class_.def("__repr__", &ShowFields);
  }

  /// A member that may be read and set.
  template <class Value>
  Record& Field(const char* name, Value T::*member, const char* doc) {
    class_.def_readwrite(name, member, doc);
    NameField(class_, name);
    return *this;
  }

  /// A member that is a result: it may be read.
  template <class Value>
  Record& Result(const char* name, Value T::*member, const char* doc) {
    class_.def_readonly(name, member, doc);
    NameField(class_, name);
    return *this;
  }

  /// The options of a table, each as a property of its type.
  Record& Options(const std::vector<OptionRow<T>>& table) {
    for (const OptionRow<T>& row : table) {
      const std::string doc = row.help + " (" + row.accepts + ")";
      const auto set = [&table, &row](T& self, const py::object& value) {
        SetOption(table, row.name, OptionText(row.name, value), &self);
      };
      const auto define = [&](auto get) {
        class_.def_property(row.name.c_str(), get, set, doc.c_str());
      };
      if (row.accepts == "true | false") {
        define([&row](const T& self) -> bool { return row.get(self) == "true"; });
      } else if (row.accepts.rfind("an integer", 0) == 0) {
        define([&row](const T& self) -> long { return std::stol(row.get(self)); });
      } else if (row.accepts.rfind("a number", 0) == 0) {
        define([&row](const T& self) -> double { return py::float_(py::str(row.get(self))); });
      } else {
        define([&row](const T& self) -> std::string { return row.get(self); });
      }
      NameField(class_, row.name.c_str());
    }
    return *this;
  }

  py::class_<T, std::shared_ptr<T>>& Class() { return class_; }

 private:
  static T Made(const py::dict& fields) {
    const py::object made = py::cast(T());
    SetFields(made, fields);
    return std::move(*made.cast<T*>());
  }

  py::class_<T, std::shared_ptr<T>> class_;
};

/// Options as keywords, on top of an object of them or the defaults.
template <class T>
T OptionsFrom(const T* options, const py::dict& keywords) {
  if (keywords.empty()) return options ? *options : T();
  const py::object made = py::cast(options ? T(*options) : T());
  SetFields(made, keywords);
  return *made.cast<T*>();
}

}  // namespace graticule::python
