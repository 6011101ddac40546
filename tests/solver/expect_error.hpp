#pragma once

#include <gtest/gtest.h>

#include <string>

#include "graticule/solver/error.hpp"

namespace graticule::testing {

/// Runs `action` and expects an Error of this kind whose message holds each of `needles`.
template <class Action>
void ExpectError(ErrorKind kind, const std::vector<std::string>& needles, Action&& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(static_cast<int>(error.Kind()), static_cast<int>(kind)) << error.what();
    for (const std::string& needle : needles)
      EXPECT_NE(std::string(error.what()).find(needle), std::string::npos)
          << "expected '" << needle << "' in: " << error.what();
    return;
  }
  ADD_FAILURE() << "expected an Error";
}

}  // namespace graticule::testing
