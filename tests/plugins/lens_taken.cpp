// A plug-in whose lens has a built-in model's name, and types that go by another.

#include <graticule/factors/lens_sdk.hpp>

namespace {

struct OwnPinhole : graticule::PinholeLens {
  static constexpr const char* kName = "own_pinhole";
};

struct NamedPinhole : graticule::PinholeLens {};

const graticule_plugin_v1* Types() {
  return graticule::sdk::LensPlugin<OwnPinhole>("taken", "1", "MIT");
}

}  // namespace

extern "C" __attribute__((visibility("default"))) const graticule_plugin_v1*
graticule_plugin_entry_v1() {
  return Types();
}

extern "C" __attribute__((visibility("default"))) const graticule_lenses_v1*
graticule_lenses_entry_v1() {
  return graticule::sdk::LensesOf<NamedPinhole>();
}
