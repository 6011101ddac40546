#include "graticule/solver/registry.hpp"

#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "graticule/factors/builtins.hpp"

namespace graticule {
namespace {

using testing::ExpectError;

TEST(Registry, KnowsEveryVectorWithoutBeingTold) {
  const Registry types;
  for (const char* name : {"vector1/1", "vector17/1", "vector4096/1"})
    EXPECT_TRUE(types.FindVariableType(name)) << name;
  for (const char* name : {"vector/1", "vector0/1", "vector01/1", "vector4097/1", "vector3/2",
                           "vector-1/1", "vector3", "Vector3/1", "vector99999999999/1"})
    EXPECT_FALSE(types.FindVariableType(name)) << name;
  EXPECT_EQ(types.FindVariableType("vector17/1")->Size(), 17);
}

TEST(Registry, RefusesANameThatIsTakenWithBothOrigins) {
  Registry types = Builtins();
  FactorType again = *types.FindFactorType("between_se2/1");
  again.origin = "/somewhere/libagain.so";
  ExpectError(ErrorKind::kMissingType,
              {"between_se2/1", "/somewhere/libagain.so", "is already taken", "built-in"},
              [&] { types.Add(again); });
  EXPECT_EQ(types.FindFactorType("between_se2/1")->origin, "built-in");
  VariableType se2 = *types.FindVariableType("se2/1");
  ExpectError(ErrorKind::kMissingType, {"se2/1", "already taken"}, [&] { types.Add(se2); });
  VariableType vector = *types.FindVariableType("vector2/1");
  ExpectError(ErrorKind::kMissingType, {"vector2/1", "already taken"}, [&] { types.Add(vector); });
  se2.name = "any/1";
  ExpectError(ErrorKind::kMissingType, {"any/1", "already taken"}, [&] { types.Add(se2); });
  again.name = "gaussian/1";
  ExpectError(ErrorKind::kMissingType, {"gaussian/1", "already taken"}, [&] { types.Add(again); });
  EXPECT_TRUE(Registry().FindFactorType("gaussian/1")->Known());
}

TEST(Registry, RefusesAFactorOfAVariableThatNobodyProvides) {
  Registry types;
  const FactorType between = *Builtins().FindFactorType("between_se2/1");
  ExpectError(ErrorKind::kMissingType, {"between_se2/1", "se2/1", "nobody provides"},
              [&] { types.Add(between); });
  EXPECT_TRUE(types.FactorTypes().empty());
}

TEST(Registry, IsAPlainValue) {
  const Registry original = Builtins();
  Registry copy = original;
  FactorType mine = *original.FindFactorType("between_se2/1");
  mine.name = "mine/1";
  copy.Add(mine);
  EXPECT_TRUE(copy.FindFactorType("mine/1"));
  EXPECT_FALSE(original.FindFactorType("mine/1"));
}

TEST(Registry, ListsByName) {
  const Registry types = Builtins();
  const auto factors = types.FactorTypes();
  for (std::size_t i = 1; i < factors.size(); ++i)
    EXPECT_LT(factors[i - 1]->name, factors[i]->name);
  for (const FactorType* type : factors) {
    EXPECT_FALSE(type->summary.empty()) << type->name;
    EXPECT_TRUE(type->Known());
  }
}

}  // namespace
}  // namespace graticule
