// Where plug-ins are looked for.

#include <gtest/gtest.h>

#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "load.hpp"

namespace graticule {
namespace {

using testing::PluginFile;

class PluginSearch : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = ::testing::TempDir() + "graticule_plugin_path_" + std::to_string(getpid());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_ + "/a");
    std::filesystem::create_directories(folder_ + "/b");
  }
  void TearDown() override {
    unsetenv("GRATICULE_PLUGIN_PATH");
    std::filesystem::remove_all(folder_);
  }
  void Put(const std::string& plugin, const std::string& where) {
    std::filesystem::copy_file(PluginFile(plugin), folder_ + where);
  }
  void SetPath(const std::string& path) { setenv("GRATICULE_PLUGIN_PATH", path.c_str(), 1); }

  std::string folder_;
};

TEST_F(PluginSearch, GoesThroughTheVariableThenTheInstallation) {
  SetPath("/first:/second::/third:");
  const std::vector<std::string> path = PluginPath();
  ASSERT_GE(path.size(), 4u);
  EXPECT_EQ(path[0], "/first");
  EXPECT_EQ(path[1], "/second");
  EXPECT_EQ(path[2], "/third");
  EXPECT_NE(path.back().find("graticule/plugins"), std::string::npos);
}

TEST_F(PluginSearch, LoadsEveryLibraryOfEveryFolderInOrder) {
  Put("straight", "/b/libz.so");
  Put("radar", "/b/liba.so");
  Put("unit_vector", "/a/libu.so");
  Put("no_entry", "/a/libignored.so.1");
  SetPath(folder_ + "/a:" + folder_ + "/missing:" + folder_ + "/b");
  Registry types = Builtins();
  const std::vector<PluginInfo> loaded = LoadPluginsFromPath(&types);
  ASSERT_EQ(loaded.size(), 3u);
  EXPECT_EQ(loaded[0].name, "directions");
  EXPECT_EQ(loaded[1].name, "radar");
  EXPECT_EQ(loaded[2].name, "bent");
  EXPECT_TRUE(types.FindFactorType("bent/1"));
}

TEST_F(PluginSearch, RefusesABadLibraryByName) {
  Put("no_entry", "/a/libbad.so");
  SetPath(folder_ + "/a");
  Registry types = Builtins();
  try {
    LoadPluginsFromPath(&types);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("libbad.so"), std::string::npos);
  }
}

}  // namespace
}  // namespace graticule
