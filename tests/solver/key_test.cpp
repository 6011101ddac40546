#include "graticule/solver/key.hpp"

#include <gtest/gtest.h>

#include <set>
#include <unordered_set>

#include "expect_error.hpp"

namespace graticule {
namespace {

TEST(Key, IsReadAsItIsWritten) {
  for (const char* text : {"pose:0", "pose:12", "robot-1.cam_0:18446744073709551615", "a:7",
                           "abcdefghijklmnopqrstuvw:1"}) {
    const Key key(text);
    EXPECT_EQ(key.ToString(), text);
    EXPECT_EQ(Key(key.Family(), key.Number()), key);
  }
  EXPECT_EQ(Key("pose:12").Family(), "pose");
  EXPECT_EQ(Key("pose:12").Number(), 12u);
}

TEST(Key, RefusesWhatIsNoKey) {
  for (const char* text : {"", ":", "pose", "pose:", ":1", "1pose:1", "po se:1", "pose:-1",
                           "pose:+1", "pose:1 ", "pose: 1", "pose:1.5", "pose:18446744073709551616",
                           "pose:1:2", "_a:1", "abcdefghijklmnopqrstuvwx:1", "p\xc3\xb6se:1"}) {
    Key key("unchanged:1");
    EXPECT_FALSE(Key::Parse(text, &key)) << text;
    EXPECT_EQ(key, Key("unchanged:1"));
    testing::ExpectError(ErrorKind::kInput, {"expected a key such as pose:12"}, [&] { Key{text}; });
  }
  testing::ExpectError(ErrorKind::kInput, {"expected a key family"}, [] { Key("", 1); });
}

TEST(Key, IsOrderedByFamilyThenByNumber) {
  const std::vector<Key> sorted = {Key("a:10"),   Key("a.b:0"),   Key("ab:0"),
                                   Key("pose:9"), Key("pose:10"), Key("pose:18446744073709551615"),
                                   Key("poses:0")};
  for (std::size_t i = 0; i < sorted.size(); ++i)
    for (std::size_t j = 0; j < sorted.size(); ++j) {
      EXPECT_EQ(sorted[i] < sorted[j], i < j) << i << " " << j;
      EXPECT_EQ(sorted[i] == sorted[j], i == j);
      EXPECT_EQ(sorted[i] != sorted[j], i != j);
    }
}

TEST(Key, HasAHashOfItsOwn) {
  std::unordered_set<std::size_t> hashes;
  for (const char* family : {"a", "b", "pose", "posf"})
    for (std::uint64_t i = 0; i < 1000; ++i) hashes.insert(KeyHash()(Key(family, i)));
  EXPECT_EQ(hashes.size(), 4000u);
  EXPECT_EQ(KeyHash()(Key("pose:5")), KeyHash()(Key("pose", 5)));
}

}  // namespace
}  // namespace graticule
