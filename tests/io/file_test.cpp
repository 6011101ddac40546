#include "graticule/io/file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>

#include "graphs.hpp"

namespace graticule {
namespace {

std::size_t FilesIn(const TemporaryDirectory& directory) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(directory.Path()))
    count += entry.exists();
  return count;
}

TEST(File, ReadsBackWhatItWrote) {
  const TemporaryDirectory directory;
  const std::string contents = std::string("line\n\0binary\xff", 13) + std::string(200000, 'x');
  for (const char* name : {"plain", "packed.gz"}) {
    WriteFile(directory / name, contents);
    EXPECT_EQ(ReadFile(directory / name), contents);
  }
  EXPECT_LT(std::filesystem::file_size(directory / "packed.gz"), 10000u);
  EXPECT_EQ(FilesIn(directory), 2u) << "a temporary file was left";
}

TEST(File, PacksTheSameBytesEveryTime) { EXPECT_EQ(Gzip("contents"), Gzip("contents")); }

TEST(File, KnowsGzipByItsFirstBytesNotItsName) {
  const TemporaryDirectory directory;
  WriteFile(directory / "plain.g2o", Gzip("contents"));
  EXPECT_EQ(ReadFile(directory / "plain.g2o"), "contents");
}

TEST(File, ReadsSeveralGzipPartsAsOne) {
  EXPECT_EQ(Gunzip(Gzip("one ") + Gzip("two") + std::string(3, '\0'), "a.gz"), "one two");
}

TEST(File, RefusesGzipThatWasCutShortAnywhere) {
  const std::string whole = Gzip("some contents, some contents, some contents");
  for (std::size_t size = 2; size < whole.size(); ++size)
    EXPECT_THROW(Gunzip(whole.substr(0, size), "a.gz"), Error) << size;
}

TEST(File, RefusesGzipThatIsDamaged) {
  std::string whole = Gzip("some contents, some contents, some contents");
  whole[whole.size() - 6] = static_cast<char>(whole[whole.size() - 6] ^ 1);  // in the checksum
  EXPECT_NE(MessageOf([&] { Gunzip(whole, "a.gz"); }).find("a.gz: the gzip data at byte"),
            std::string::npos);
}

TEST(File, SaysWhyItCannotRead) {
  const TemporaryDirectory directory;
  EXPECT_EQ(MessageOf([&] { ReadFile(directory / "none"); }),
            directory / "none" + std::string(": No such file or directory"));
  EXPECT_EQ(MessageOf([&] { ReadFile(directory.Path().string()); }),
            directory.Path().string() + ": Is a directory");
}

TEST(File, SaysThatTheDiskIsFull) {
  const std::string message = MessageOf([] { WriteFile("/dev/full", "contents"); });
  EXPECT_EQ(message, "/dev/full: No space left on device");
}

TEST(File, WritesToDevicesWithoutReplacingThem) {
  WriteFile("/dev/null", "contents");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(File, RefusesToReplaceADirectory) {
  const TemporaryDirectory directory;
  EXPECT_THROW(WriteFile(directory.Path().string(), "contents"), Error);
}

TEST(File, LeavesTheOldContentsWhereItFails) {
  const TemporaryDirectory directory;
  EXPECT_THROW(WriteFile(directory / "none/file", "contents"), Error);
  EXPECT_EQ(FilesIn(directory), 0u);
}

// The limit on a file's size stands in for a full disk: write() fails half-way all the same.
TEST(File, LeavesTheOldContentsWhereTheDiskFillsUp) {
  const TemporaryDirectory directory;
  WriteFile(directory / "file", "old");
  struct rlimit before {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  struct rlimit small = before;
  small.rlim_cur = 4096;
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string message =
      MessageOf([&] { WriteFile(directory / "file", std::string(100000, 'x')); });
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(message, directory / "file" + std::string(": File too large"));
  EXPECT_EQ(ReadFile(directory / "file"), "old");
  EXPECT_EQ(FilesIn(directory), 1u) << "the temporary file was left";
}

TEST(File, KeepsModeAndSymbolicLinks) {
  const TemporaryDirectory directory;
  WriteFile(directory / "real", "old");
  ::chmod((directory / "real").c_str(), 0640);
  ASSERT_EQ(::symlink("real", (directory / "link").c_str()), 0);
  WriteFile(directory / "link", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(directory / "link"));
  EXPECT_EQ(ReadFile(directory / "real"), "new");
  // One that points to what is not there yet, by another.
  ASSERT_EQ(::symlink("later", (directory / "dangling").c_str()), 0);
  ASSERT_EQ(::symlink((directory / "dangling").c_str(), (directory / "second").c_str()), 0);
  WriteFile(directory / "second", "made");
  EXPECT_TRUE(std::filesystem::is_symlink(directory / "second"));
  EXPECT_TRUE(std::filesystem::is_symlink(directory / "dangling"));
  EXPECT_EQ(ReadFile(directory / "later"), "made");
  struct stat status {};
  ASSERT_EQ(::stat((directory / "real").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777u, 0640u);
}

}  // namespace
}  // namespace graticule
