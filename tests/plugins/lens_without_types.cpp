// A plug-in whose lens has none of the types that it needs.

#include <graticule/factors/lens_sdk.hpp>

namespace {

struct Bare : graticule::PinholeLens {
  static constexpr const char* kName = "bare";
};

}  // namespace

extern "C" __attribute__((visibility("default"))) const graticule_plugin_v1*
graticule_plugin_entry_v1() {
  static const graticule_plugin_v1 plugin = {sizeof(graticule_plugin_v1),
                                             GRATICULE_ABI_VERSION,
                                             "bare",
                                             "1",
                                             "MIT",
                                             0,
                                             0,
                                             nullptr,
                                             nullptr};
  return &plugin;
}

extern "C" __attribute__((visibility("default"))) const graticule_lenses_v1*
graticule_lenses_entry_v1() {
  return graticule::sdk::LensesOf<Bare>();
}
