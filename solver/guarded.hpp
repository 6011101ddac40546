#pragma once

#include <exception>
#include <string>

#include "graticule/solver/plugin_abi.h"

namespace graticule {

/// What a callee wrote, or `otherwise`; the callee may have left out the zero at the end.
inline std::string Reason(graticule_error* error, const char* otherwise) {
  error->message[sizeof(error->message) - 1] = 0;
  return error->message[0] ? error->message : otherwise;
}

/// Of the exception that is being handled.  Factors built with the SDK never throw; a table made by
/// hand may, and neither Ceres nor a thread survives that.
inline std::string ThrownReason() {
  try {
    throw;
  } catch (const std::exception& exception) {
    return std::string("threw: ") + exception.what();
  } catch (...) {
    return "threw something that is not a std::exception";
  }
}

/// The factor, or null with the reason.
inline void* CreateFactor(const graticule_factor_type_v1& table,
                          const graticule_measurement& measurement, std::int32_t block_count,
                          std::int32_t* residual_count, std::string* why) {
  graticule_error error;
  error.message[0] = 0;
  try {
    void* factor = table.create(&measurement, block_count, residual_count, &error);
    if (!factor) *why = Reason(&error, "refused without a reason");
    return factor;
  } catch (...) {
    *why = ThrownReason();
    return nullptr;
  }
}

}  // namespace graticule
