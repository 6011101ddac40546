// Files that are wrong in one way each, and files that only look wrong.

#include <gtest/gtest.h>

#include <set>

#include "broken_files.hpp"
#include "graphs.hpp"
#include "graticule/io/carmen.hpp"
#include "graticule/io/config.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/problem_file.hpp"
#include "graticule/io/relations.hpp"
#include "graticule/io/trajectory.hpp"
#include "test_registry.hpp"

namespace graticule {
namespace {

namespace fs = std::filesystem;

void Load(const std::string& directory, const std::string& name) {
  const std::string contents = ReadFile(directory + "/" + name);
  const std::string extension = fs::path(name).extension().string();
  if (extension == ".yaml") {
    ParseConfig(contents, name);
  } else if (extension == ".tum") {
    ParseTum(contents, name);
  } else if (extension == ".clf") {
    LaserLog log;
    ParseCarmen(contents, name, {}, &log);
  } else if (extension == ".relations") {
    ParseRelations(contents, name);
  } else {
    ParseProblem(contents, name, TestRegistry());
  }
}

TEST(BrokenFiles, AreRefusedAtTheirPlaceWithAReason) {
  for (const BrokenFile& file : kBrokenFiles) {
    SCOPED_TRACE(file.name);
    const std::string message = MessageOf([&] { Load(GRATICULE_BROKEN_DIR, file.name); });
    const std::string place = *file.place ? std::string(":") + file.place + ": " : ": ";
    EXPECT_NE(message.find(file.name + place + file.message), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << "one line";
    EXPECT_LT(message.size(), 600u);
  }
}

TEST(BrokenFiles, AreAllInTheTable) {
  std::set<std::string> names;
  for (const BrokenFile& file : kBrokenFiles) names.insert(file.name);
  for (const auto& entry : fs::directory_iterator(GRATICULE_BROKEN_DIR)) {
    if (!entry.is_regular_file()) continue;
    EXPECT_EQ(names.erase(entry.path().filename().string()), 1u) << entry.path();
  }
  EXPECT_TRUE(names.empty()) << *names.begin() << " is not there";
}

TEST(BrokenFiles, LoadWhereTheyOnlyLookBroken) {
  std::size_t count = 0;
  const std::string directory = std::string(GRATICULE_BROKEN_DIR) + "/legal";
  for (const auto& entry : fs::directory_iterator(directory)) {
    ++count;
    EXPECT_NO_THROW(Load(directory, entry.path().filename().string())) << entry.path();
  }
  EXPECT_GE(count, 10u);
}

TEST(BrokenFiles, WithALineOfTenMegabytesAreRefusedInOneShortLine) {
  const std::string junk(10'000'000, 'x');
  for (const std::string& text : {junk, "VERTEX_SE2 " + junk, "VERTEX_SE2 0 0 0 0" + junk}) {
    const std::string message = MessageOf([&] { ParseProblem(text, "long.g2o", TestRegistry()); });
    EXPECT_EQ(message.substr(0, 11), "long.g2o:1:");
    EXPECT_LT(message.size(), 600u);
  }
}

// A g2o file has no end mark: cut between two lines it is a smaller problem, and nobody can tell.
TEST(BrokenFiles, CutInsideALineAreRefusedInEveryFormat) {
  const struct {
    const char* name;
    std::string text;
  } files[] = {
      {"a.g2o", "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nFIX 0\n"},
      {"a.graph", "VERTEX2 0 0 0 0\nVERTEX2 1 1 0 0\nEDGE2 0 1 1 0 0 1 0 1 1 0 0\nEQUIV 0 1\n"},
      {"a.bal", "1 1 1\n0 0 1 2\n0\n0\n0\n0\n0\n0\n1\n0\n0\n1\n2\n3\n"},
  };
  for (const auto& file : files) {
    ASSERT_NO_THROW(ParseProblem(file.text, file.name, TestRegistry()));
    for (std::size_t at = file.text.find(' '); at != std::string::npos;
         at = file.text.find(' ', at + 1))
      EXPECT_THROW(ParseProblem(file.text.substr(0, at), file.name, TestRegistry()), Error)
          << file.name << " cut at byte " << at;
  }
}

}  // namespace
}  // namespace graticule
