#include "bind.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/factors/lens_plugin.hpp"
#include "graticule/factors/make.hpp"
#include "graticule/solver/graph.hpp"
#include "graticule/solver/plugin.hpp"

namespace graticule::python {
namespace {

using namespace py::literals;

void BindKey(py::module_& m) {
  py::class_<Key>(m, "Key",
                  "The name of a variable: a family and a number, written `pose:12`.  Ordered by "
                  "family, then by number.  A text does wherever a key is asked for.")
      .def(py::init<std::string_view>(), "text"_a, "From `family:number`.")
      .def(py::init<std::string_view, std::uint64_t>(), "family"_a, "number"_a,
           "From its parts; a family is 1 to 23 of [A-Za-z0-9_.-] and begins with a letter.")
      .def_property_readonly(
          "family", [](const Key& key) { return std::string(key.Family()); }, "\"pose\"")
      .def_property_readonly("number", &Key::Number, "12")
      .def("__str__", &Key::ToString)
      .def("__repr__", [](const Key& key) { return "Key('" + key.ToString() + "')"; })
      .def("__hash__", [](const Key& key) { return py::hash(py::str(key.ToString())); })
      .def(
          "__eq__",
          [](const Key& key, const py::object& other) {
            if (py::isinstance<Key>(other)) return key == other.cast<const Key&>();
            // Only the text whose hash it has: "pose:01" is not it.
            return py::isinstance<py::str>(other) && key.ToString() == other.cast<std::string>();
          },
          "other"_a)
      .def(
          "__lt__", [](const Key& a, const Key& b) { return a < b; }, "other"_a)
      .def(py::pickle([](const Key& key) { return key.ToString(); },
                      [](const std::string& text) { return Key(text); }));
  py::implicitly_convertible<py::str, Key>();
}

void BindNoise(py::module_& m) {
  py::enum_<NoiseKind>(m, "NoiseKind", "What a noise's values are.")
      .value("UNIT", NoiseKind::kUnit, "None: the residual counts as it is.")
      .value("SIGMA", NoiseKind::kSigma, "Standard deviations, one for all or one each.")
      .value("INFORMATION", NoiseKind::kInformation,
             "The inverse covariance: its upper triangle row by row.");
  Record<Noise>(m, "Noise",
                "How much a factor's residual is minded: its cost is 0.5 r' W r, with W the "
                "information.  A number stands for Noise.sigma, a row of numbers for Noise.sigmas.")
      .Field("kind", &Noise::kind, "What the values are.")
      .Field("values", &Noise::values, "(0,), (1,), (n,) or (n (n + 1) / 2,), by kind.")
      .Class()
      .def(py::init([](double sigma) { return Noise::Sigma(sigma); }), "sigma"_a,
           "One standard deviation for every component, in the residual's units.")
      .def(py::init([](std::vector<double> sigmas) { return Noise::Sigmas(std::move(sigmas)); }),
           "sigmas"_a, "(n,) standard deviations, in the residual's order and units.")
      .def_static("unit", &Noise::Unit, "The residual counts as it is.")
      .def_static("sigma", &Noise::Sigma, "sigma"_a,
                  "One standard deviation for every component, in the residual's units.")
      .def_static("sigmas", &Noise::Sigmas, "sigmas"_a,
                  "(n,) standard deviations, in the residual's order and units.")
      .def_static(
          "information",
          [](const Dense<double>& matrix) {
            std::vector<double> upper;
            if (matrix.ndim() == 1) {
              upper.assign(matrix.data(), matrix.data() + matrix.size());
            } else {
              ExpectShape(matrix, {-1, matrix.ndim() ? matrix.shape(0) : 0}, "information");
              for (py::ssize_t i = 0; i < matrix.shape(0); ++i)
                for (py::ssize_t j = i; j < matrix.shape(0); ++j) {
                  if (matrix.at(i, j) != matrix.at(j, i))
                    throw Error("information: the matrix is not symmetric", ErrorKind::kUsage);
                  upper.push_back(matrix.at(i, j));
                }
            }
            return Noise::Information(std::move(upper));
          },
          "matrix"_a,
          "(n, n), the inverse covariance, symmetric; or (n (n + 1) / 2,), its upper triangle "
          "row by row.");
  py::implicitly_convertible<py::float_, Noise>();
  py::implicitly_convertible<py::int_, Noise>();
  py::implicitly_convertible<py::list, Noise>();
  py::implicitly_convertible<py::tuple, Noise>();
  py::implicitly_convertible<py::array, Noise>();
}

void BindLoss(py::module_& m) {
  py::class_<Loss>(m, "Loss",
                   "How far a factor is believed when it disagrees: with whitened squared norm "
                   "s = r' W r it costs 0.5 rho(s).")
      .def(py::init([](const std::string& name, double scale) { return MakeLoss(name, scale); }),
           "name"_a = "none", "scale"_a = 1.0,
           "By name (`loss_names()`); `scale` is the whitened norm where it leaves the parabola.")
      .def_property_readonly(
          "name", [](const Loss& loss) { return std::string(LossName(loss.kind)); }, "\"huber\"")
      .def_readonly("scale", &Loss::scale, "The whitened norm where it leaves the parabola.")
      .def(
          "__eq__", [](const Loss& a, const Loss& b) { return a == b; }, "other"_a)
      .def(
          "evaluate",
          [](const Loss& loss, double s) {
            std::array<double, 3> rho;
            EvaluateLoss(loss, s, rho.data());
            return rho;
          },
          "s"_a, "(3,) rho(s), rho'(s), rho''(s).")
      .def("__repr__",
           [](const Loss& loss) {
             return "Loss('" + std::string(LossName(loss.kind)) + "', " + Shown(loss.scale) + ")";
           })
      .def(py::pickle(
          [](const Loss& loss) {
            return py::make_tuple(std::string(LossName(loss.kind)), loss.scale);
          },
          [](const py::tuple& t) {
            return MakeLoss(t[0].cast<std::string>(), t[1].cast<double>());
          }));
  m.def(
      "loss_names", [] { return LossNames(); }, "Names of the losses.");
}

std::vector<std::pair<std::string, std::string>> PairsOf(const Fields& fields) {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const Field& field : fields) pairs.emplace_back(field.name, field.unit);
  return pairs;
}

void BindTypeClasses(py::module_& m) {
  const auto sized = [](const Dense<double>& x, int size, const char* what) {
    ExpectShape(x, {size}, what);
    return x.data();
  };
  py::class_<VariableType>(m, "VariableType",
                           "What a variable is made of: its stored fields, and how a small change "
                           "in its tangent space is applied.")
      .def_readonly("name", &VariableType::name, "\"se2/1\"")
      .def_readonly("summary", &VariableType::summary, "One line.")
      .def_readonly("origin", &VariableType::origin, "\"built-in\", or the plug-in's file.")
      .def_property_readonly(
          "fields", [](const VariableType& t) { return PairsOf(t.fields); },
          "Name and unit of every stored number.")
      .def_property_readonly(
          "tangent", [](const VariableType& t) { return PairsOf(t.tangent); },
          "Name and unit of every number of a small change.")
      .def_property_readonly("size", &VariableType::Size, "Stored numbers.")
      .def_property_readonly("tangent_size", &VariableType::TangentSize,
                             "Numbers of a small change.")
      .def(
          "plus",
          [sized](const VariableType& t, const Dense<double>& x, const Dense<double>& delta) {
            std::vector<double> moved(static_cast<std::size_t>(t.Size()));
            t.Plus(sized(x, t.Size(), "x"), sized(delta, t.TangentSize(), "delta"), moved.data());
            return moved;
          },
          "x"_a, "delta"_a, "(size,) x moved by delta (tangent_size,), on the body side.")
      .def(
          "minus",
          [sized](const VariableType& t, const Dense<double>& y, const Dense<double>& x) {
            std::vector<double> delta(static_cast<std::size_t>(t.TangentSize()));
            t.Minus(sized(y, t.Size(), "y"), sized(x, t.Size(), "x"), delta.data());
            return delta;
          },
          "y"_a, "x"_a, "(tangent_size,) the change that leads from x to y.")
      .def("__repr__", [](const VariableType& t) {
        return "VariableType('" + t.name + "', '" + ToString(t.fields) + "')";
      });
  py::class_<FactorType>(m, "FactorType", "What a kind of factor joins, measures and returns.")
      .def_readonly("name", &FactorType::name, "\"between_se2/1\"")
      .def_readonly("summary", &FactorType::summary, "One line.")
      .def_readonly("origin", &FactorType::origin, "\"built-in\", or the plug-in's file.")
      .def_property_readonly(
          "schema", [](const FactorType& t) { return ToString(t.schema); },
          "blocks | measurement | residual, with units: \"a:se2/1 b:se2/1 | x:m y:m yaw:rad\".")
      .def_property_readonly("known", &FactorType::Known, "Whether it can be solved here.")
      .def_property_readonly("is_relative", &FactorType::IsRelative,
                             "Depends on relative placement only.")
      .def("__repr__", [](const FactorType& t) {
        return "FactorType('" + t.name + "', '" + ToString(t.schema) + "')";
      });
}

void BindRegistry(py::module_& m) {
  py::class_<Registry>(m, "Registry",
                       "The variable and factor types that are known.  A graph takes a copy: "
                       "types that are added later are not known to it.")
      .def(py::init<>(), "Without any type but vectors; `builtins()` has the built-in ones.")
      .def(
          "variable_types",
          [](const Registry& types) {
            std::vector<VariableType> copies;
            for (const VariableType* type : types.VariableTypes()) copies.push_back(*type);
            return copies;
          },
          "All of them, by name.")
      .def(
          "factor_types",
          [](const Registry& types) {
            std::vector<FactorType> copies;
            for (const FactorType* type : types.FactorTypes()) copies.push_back(*type);
            return copies;
          },
          "All of them, by name.")
      .def("find_variable_type", &Registry::FindVariableType, "name"_a, "None: no such type.")
      .def("find_factor_type", &Registry::FindFactorType, "name"_a, "None: no such type.")
      .def(
          "load_plugin",
          [](Registry& types, const std::string& file) {
            const PluginInfo info = LoadPlugin(file, &types);
            LoadLenses(file, types);
            return info;
          },
          "file"_a, "Adds a plug-in's types, and its lenses as camera models.")
      .def(
          "load_plugins_from_path",
          [](Registry& types) {
            const std::vector<PluginInfo> plugins = LoadPluginsFromPath(&types);
            for (const PluginInfo& plugin : plugins) LoadLenses(plugin.file, types);
            return plugins;
          },
          "Adds every plug-in of GRATICULE_PLUGIN_PATH (colons between), or of the "
          "installation.")
      .def("__copy__", [](const Registry& types) { return Registry(types); })
      .def("__repr__", [](const Registry& types) {
        return "Registry(" + std::to_string(types.VariableTypes().size()) + " variable types, " +
               std::to_string(types.FactorTypes().size()) + " factor types)";
      });
  m.def("builtins", &Builtins, "A registry with every built-in type.");
}

void BindFactor(py::module_& m) {
  Record<Factor>(m, "Factor", "One statement about some variables.  It is data.")
      .Field("type", &Factor::type, "\"between_se2/1\"")
      .Field("keys", &Factor::keys, "In the schema's order.")
      .Field("measurement", &Factor::measurement, "As the schema lays it out.")
      .Field("noise", &Factor::noise, "How much the residual is minded.")
      .Field("loss", &Factor::loss, "How far it is believed when it disagrees.")
      .Field("source", &Factor::source, "Who said so: \"odometry\", \"loop\".");

  m.def("prior_se2_factor", &PriorSe2Factor, "pose"_a, "world_from_body"_a, "noise"_a,
        "source"_a = "prior", "A pose is here: [x m, y m, yaw rad].");
  m.def("prior_se3_factor", &PriorSe3Factor, "pose"_a, "world_from_body"_a, "noise"_a,
        "source"_a = "prior", "A pose is here: [x y z m, qx qy qz qw].");
  m.def("between_se2_factor", &BetweenSe2Factor, "a"_a, "b"_a, "a_from_b"_a, "noise"_a,
        "source"_a = "", "Pose b, seen from pose a: [x m, y m, yaw rad].");
  m.def("between_se3_factor", &BetweenSe3Factor, "a"_a, "b"_a, "a_from_b"_a, "noise"_a,
        "source"_a = "",
        "Pose b, seen from pose a: [x y z m, qx qy qz qw].  Rotation noise is of the rotation "
        "vector [rad].");
  m.def("landmark_se2_factor", &LandmarkSe2Factor, "pose"_a, "landmark"_a, "landmark_in_body"_a,
        "noise"_a, "source"_a = "", "A landmark is here, seen from a pose: [x m, y m].");
  m.def("bearing_range_se2_factor", &BearingRangeSe2Factor, "pose"_a, "landmark"_a, "bearing_rad"_a,
        "range_m"_a, "noise"_a, "source"_a = "",
        "A landmark in this direction, so far off, seen from a pose.");
  m.def("position_se3_factor", &PositionSe3Factor, "pose"_a, "antenna_in_world"_a,
        "lever_in_body"_a, "noise"_a, "source"_a = "gnss",
        "An antenna on the body is here: east, north, up [m]; its lever [m, in the body].");
  m.def("bal_reprojection_factor", &BalReprojectionFactor, "camera"_a, "point"_a, "u_px"_a,
        "v_px"_a, "noise"_a, "source"_a = "", "A point seen by a camera, as BAL has it [px].");
}

}  // namespace

void BindTypes(py::module_& module) {
  BindKey(module);
  BindNoise(module);
  BindLoss(module);
  BindTypeClasses(module);
  Record<PluginInfo>(module, "PluginInfo", "A plug-in that was opened.")
      .Result("file", &PluginInfo::file, "Its path.")
      .Result("name", &PluginInfo::name, "As it calls itself.")
      .Result("version", &PluginInfo::version, "Its own.")
      .Result("licence", &PluginInfo::licence, "Its own.")
      .Result("variable_types", &PluginInfo::variable_types, "Names that it added.")
      .Result("factor_types", &PluginInfo::factor_types, "Names that it added.");
  BindRegistry(module);
  BindFactor(module);
}

}  // namespace graticule::python
