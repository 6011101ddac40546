#include <optional>

#include "graticule/io/document.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/text.hpp"
#include "graticule/problems/calibration/target.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr const char* kVersion = "graticule-target";
constexpr int kMost = 10000;

struct KindName {
  TargetKind kind;
  const char* name;
};
constexpr KindName kKinds[] = {{TargetKind::kTagMosaic, "mosaic"},
                               {TargetKind::kAprilGrid, "aprilgrid"},
                               {TargetKind::kCharuco, "charuco"},
                               {TargetKind::kChessboard, "chessboard"}};

int Whole(const DocumentNode& root, const char* key, int least) {
  return static_cast<int>(root.Member(key).Integer(least, kMost));
}

bool Truth(const DocumentNode& node) {
  if (node.Scalar() != "true" && node.Scalar() != "false") node.FailExpected("true or false");
  return node.Scalar() == "true";
}

Target ReadOwn(const DocumentNode& root) {
  root.Member(kVersion).Integer(1, 1);
  Target target;
  std::optional<TargetKind> kind;
  for (const KindName& known : kKinds)
    if (root.Member("kind").Scalar() == known.name) kind = known.kind;
  if (!kind) root.Member("kind").FailExpected("mosaic, aprilgrid, charuco or chessboard");
  target.kind = *kind;
  target.columns = Whole(root, "columns", 1);
  target.rows = Whole(root, "rows", 1);
  target.pitch_m = root.Member("pitch_m").Number();
  if (*kind != TargetKind::kChessboard) {
    target.family = root.Member("family").Scalar();
    target.border_cells = Whole(root, "border_cells", 1);
    target.first_id = Whole(root, "first_id", 0);
  }
  if (*kind == TargetKind::kTagMosaic) target.stride = Whole(root, "stride", 1);
  if (*kind == TargetKind::kAprilGrid) target.spacing = root.Member("spacing").Number();
  if (*kind == TargetKind::kCharuco) {
    target.marker_m = root.Member("marker_m").Number();
    target.is_legacy = Truth(root.Member("legacy"));
  }
  if (root.Member("end").Scalar() != "target") root.Member("end").FailExpected("'target'");
  return target;
}

// github.com/ethz-asl/kalibr/wiki/calibration-targets
Target ReadKalibr(const DocumentNode& root) {
  Target target;
  const DocumentNode& type = root.Member("target_type");
  if (type.Scalar() == "aprilgrid") {
    target.kind = TargetKind::kAprilGrid;
    target.family = "tag36h11";
    target.border_cells = 2;
    target.columns = Whole(root, "tagCols", 1);
    target.rows = Whole(root, "tagRows", 1);
    target.pitch_m = root.Member("tagSize").Number();
    target.spacing = root.Member("tagSpacing").Number();
    if (const DocumentNode* first = root.Find("tagIdOffset"))
      target.first_id = static_cast<int>(first->Integer(0, kMost));
  } else if (type.Scalar() == "checkerboard") {
    target.kind = TargetKind::kChessboard;
    target.columns = Whole(root, "targetCols", 1);
    target.rows = Whole(root, "targetRows", 1);
    const DocumentNode& across = root.Member("colSpacingMeters");
    target.pitch_m = across.Number();
    if (root.Member("rowSpacingMeters").Number() != target.pitch_m)
      across.Fail("expected squares: the same distance along rows and columns");
  } else {
    type.FailExpected("aprilgrid or checkerboard");
  }
  return target;
}

}  // namespace

Target ParseTarget(std::string_view text, const std::string& name) {
  const DocumentNode root = ParseYaml(text, name);
  Target target;
  if (root.Find("target_type")) {
    target = ReadKalibr(root);
  } else if (root.Find(kVersion)) {
    target = ReadOwn(root);
  } else {
    throw Error(name +
                ": expected a target's description: graticule's (graticule-target), or "
                "Kalibr's (target_type)");
  }
  try {
    CheckTarget(target);
  } catch (const Error& error) {
    throw Error(name + ": " + error.what());
  }
  return target;
}

std::string FormatTarget(const Target& target) {
  std::string text = std::string("# ") + Described(target) + "\n" + kVersion + ": 1\n";
  const auto number = [&text](const char* key, double value) {
    text += std::string(key) + ": ";
    AppendNumber(&text, value);
    text += "\n";
  };
  const auto whole = [&text](const char* key, int value) {
    text += std::string(key) + ": " + std::to_string(value) + "\n";
  };
  for (const KindName& known : kKinds)
    if (known.kind == target.kind) text += std::string("kind: ") + known.name + "\n";
  whole("columns", target.columns);
  whole("rows", target.rows);
  number("pitch_m", target.pitch_m);
  if (target.kind != TargetKind::kChessboard) {
    text += "family: " + target.family + "\n";
    whole("border_cells", target.border_cells);
    whole("first_id", target.first_id);
  }
  if (target.kind == TargetKind::kTagMosaic) whole("stride", target.stride);
  if (target.kind == TargetKind::kAprilGrid) number("spacing", target.spacing);
  if (target.kind == TargetKind::kCharuco) {
    number("marker_m", target.marker_m);
    text += std::string("legacy: ") + (target.is_legacy ? "true" : "false") + "\n";
  }
  return text + "end: target\n";
}

Target ReadTarget(const std::string& path) { return ParseTarget(ReadFile(path), path); }

void WriteTarget(const std::string& path, const Target& target) {
  CheckTarget(target);
  WriteFile(path, FormatTarget(target));
}

}  // namespace graticule
