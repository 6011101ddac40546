#pragma once

#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "graticule/factors/builtins.hpp"
#include "graticule/solver/rotation.hpp"

namespace graticule::testing {

/// A factor made and evaluated through its C table, as the solver does it.
class Made {
 public:
  Made(const std::string& type, const std::vector<double>& measurement)
      : Made(*Builtins().FindFactorType(type), measurement) {}

  Made(const FactorType& type, const std::vector<double>& measurement) : type_(type) {
    const graticule_measurement m = {sizeof(graticule_measurement),
                                     static_cast<std::int32_t>(measurement.size()),
                                     measurement.data()};
    graticule_error error{};
    factor_ = type_.table->create(&m, static_cast<std::int32_t>(type_.schema.blocks.size()), &size_,
                                  &error);
    if (!factor_) throw std::runtime_error(error.message);
  }
  Made(const Made&) = delete;
  Made& operator=(const Made&) = delete;
  ~Made() { type_.table->destroy(factor_); }

  int Size() const { return size_; }

  bool Evaluate(const std::vector<std::vector<double>>& blocks, std::vector<double>* residual,
                std::vector<std::vector<double>>* jacobians = nullptr) const {
    std::vector<const double*> x;
    for (const auto& block : blocks) x.push_back(block.data());
    residual->assign(static_cast<std::size_t>(size_), std::nan(""));
    std::vector<double*> j;
    if (jacobians) {
      jacobians->clear();
      for (std::size_t b = 0; b < blocks.size(); ++b)
        jacobians->emplace_back(static_cast<std::size_t>(size_) * Columns(b), std::nan(""));
      for (auto& jacobian : *jacobians) j.push_back(jacobian.data());
    }
    graticule_error error{};
    return type_.table->evaluate(factor_, x.data(), residual->data(),
                                 jacobians ? j.data() : nullptr, &error) != 0;
  }

  /// The residual; throws if there is none.
  std::vector<double> operator()(const std::vector<std::vector<double>>& blocks) const {
    std::vector<double> residual;
    if (!Evaluate(blocks, &residual)) throw std::runtime_error(type_.name + ": not evaluated");
    return residual;
  }

  static VariableType Variable(const std::string& name) {
    static const Registry types = Builtins();
    return *types.FindVariableType(name);
  }
  std::size_t Columns(std::size_t block) const {
    const VariableType variable = Variable(type_.schema.blocks[block].variable_type);
    return static_cast<std::size_t>(type_.HasTangentJacobians() ? variable.TangentSize()
                                                                : variable.Size());
  }

 private:
  FactorType type_;
  void* factor_ = nullptr;
  std::int32_t size_ = 0;
};

using Random = std::mt19937_64;

inline double Uniform(Random* random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(*random);
}

inline std::vector<double> RandomQuaternion(Random* random) {
  std::normal_distribution<double> normal;
  std::vector<double> q(4);
  double squared = 0;
  for (double& value : q) {
    value = normal(*random);
    squared += value * value;
  }
  for (double& value : q) value /= std::sqrt(squared);
  return q;
}

/// A value of a variable, by its fields' names: quaternions of unit length, lengths of metres.
inline std::vector<double> RandomValue(const VariableType& type, Random* random) {
  if (type.name == "bal_camera/1") {  // in front of it: points of +-1 are at a depth of 3 to 7
    std::vector<double> camera;
    for (int i = 0; i < 3; ++i) camera.push_back(Uniform(random, -1.5, 1.5));
    camera.insert(camera.end(), {Uniform(random, -1, 1), Uniform(random, -1, 1), -5});
    camera.insert(camera.end(),
                  {Uniform(random, 300, 900), Uniform(random, -.1, .1), Uniform(random, -.1, .1)});
    return camera;
  }
  if (type.name.rfind("camera_", 0) == 0) {  // lenses as they are: mild terms
    std::vector<double> camera;
    for (const Field& field : type.fields) {
      if (field.name[0] == 'f') camera.push_back(Uniform(random, 300, 900));
      if (field.name[0] == 'c') camera.push_back(Uniform(random, 200, 600));
      if (field.name[0] == 'k' || field.name[0] == 'p')
        camera.push_back(Uniform(random, -.03, .03));
      if (field.name == "alpha") camera.push_back(Uniform(random, .1, .7));
      if (field.name == "beta") camera.push_back(Uniform(random, .8, 1.2));
      if (field.name == "xi") camera.push_back(Uniform(random, -.3, .3));
    }
    return camera;
  }
  std::vector<double> value;
  for (const Field& field : type.fields) {
    if (field.name == "qx") {
      for (const double q : RandomQuaternion(random)) value.push_back(q);
    } else if (field.name[0] != 'q') {
      value.push_back(field.unit == "rad" ? Uniform(random, -3.1, 3.1) : Uniform(random, -1, 1));
    }
  }
  return value;
}

/// Poses that put a target's points, within 15 m of its origin, at a depth of 1 m and more.
inline void PlaceBeforeTheCamera(std::vector<double>* camera_from_rig,
                                 std::vector<double>* rig_from_target, Random* random) {
  const double turn[3] = {Uniform(random, -.1, .1), Uniform(random, -.1, .1),
                          Uniform(random, -3, 3)};
  for (int i = 0; i < 3; ++i) (*camera_from_rig)[i] = Uniform(random, -.2, .2);
  QuaternionExp(turn, camera_from_rig->data() + 3);
  (*rig_from_target)[2] = Uniform(random, 18, 25);
}

/// A measurement by its fields' names.
inline std::vector<double> RandomMeasurement(const FactorSchema& schema, Random* random) {
  std::vector<double> value;
  for (const Field& field : schema.measurement) {
    if (field.name == "qx" || field.name == "sqx") {
      for (const double q : RandomQuaternion(random)) value.push_back(q);
    } else if (field.name[0] != 'q' && field.name.substr(0, 2) != "sq") {
      const double low = field.name == "sigma" ? .5 : field.name == "range" ? 0 : -2;
      // 2e-4 degrees are 22 m: far places have residuals with fewer digits behind the point.
      value.push_back(field.unit == "deg" ? 1e-4 * Uniform(random, -2, 2)
                                          : Uniform(random, low, field.unit == "px" ? 300 : 2));
    }
  }
  return value;
}

}  // namespace graticule::testing
