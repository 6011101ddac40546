#include "command.hpp"

namespace graticule::test {
namespace {

using CalibrateTarget = CommandTest;

TEST_F(CalibrateTarget, IsPrintedWithItsDescription) {
  for (const char* name : {"target.pdf", "target.svg", "target.png"}) {
    const Outcome outcome = RunCommand(
        {"calibrate", "target", "--family", "tag36h11", "--size", "A3", "-o", Path(name)});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("mosaic of 10 x 7 tag36h11 tags, 38.1 mm from one to the next"),
              std::string::npos)
        << outcome.err;
    const std::string page = ReadWhole(Path(name));
    EXPECT_GT(page.size(), 10000u);
    RunCommand({"calibrate", "target", "--size", "A3", "-o", Path(name)});
    EXPECT_EQ(ReadWhole(Path(name)), page) << "the same target is the same file";
  }
  EXPECT_NE(ReadWhole(Path("target.yaml")).find("kind: mosaic\n"), std::string::npos);
  EXPECT_NE(ReadWhole(Path("target.svg")).find("width=\"420mm\" height=\"297mm\""),
            std::string::npos);
  // 420 x 297 mm, in points.
  EXPECT_NE(ReadWhole(Path("target.pdf")).find("MediaBox [ 0 0 1190.551181 841.889764 ]"),
            std::string::npos);
}

TEST_F(CalibrateTarget, SaysWhyItCannotBePrinted) {
  const struct {
    std::vector<std::string> words;
    const char* message;
  } cases[] = {
      {{"--size", "A9", "-o", Path("a.pdf")}, "there is no paper 'A9'"},
      {{"--family", "tag1", "-o", Path("a.pdf")}, "there is no family of markers 'tag1'"},
      {{"--kind", "circles", "-o", Path("a.pdf")}, "there is no kind of target 'circles'"},
      {{"--pitch", "400", "-o", Path("a.pdf")}, "the page has"},
      {{"-o", Path("a.doc")}, "expected a name that ends in .pdf, .svg or .png"},
  };
  for (const auto& c : cases) {
    std::vector<std::string> words = {"calibrate", "target"};
    words.insert(words.end(), c.words.begin(), c.words.end());
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err.find(c.message), std::string::npos) << outcome.err;
    EXPECT_EQ(CountLines(outcome.err), 1u) << outcome.err;
  }
  EXPECT_TRUE(Files().empty());
}

}  // namespace
}  // namespace graticule::test
