// What the command promises to people and to programs.

#include <algorithm>

#include "command.hpp"

namespace graticule::test {
namespace {

class Solve : public CommandTest {
 protected:
  std::string Square() const { return Write("square.g2o", kSquare); }
};

TEST_F(Solve, TakesSeveralSettings) {
  const auto report = JsonOf(RunCommand(
      {"solve", Square(), "--json", "--set", "max_iterations=7", "-s", "method=dogleg"}));
  EXPECT_EQ(report["options"]["max_iterations"], "7");
  EXPECT_EQ(report["options"]["method"], "dogleg");
}

}  // namespace
}  // namespace graticule::test
