#include <fmt/core.h>

#include "commands.hpp"
#include "graticule/problems/calibration/print_target.hpp"
#include "graticule/solver/error.hpp"

namespace graticule::apps {
namespace {

TargetKind KindOf(const CalibrateTargetCommand& command) {
  const std::string kind = !command.kind.empty()                        ? command.kind
                           : command.family.compare(0, 5, "DICT_") == 0 ? "charuco"
                                                                        : "mosaic";
  if (kind == "mosaic") return TargetKind::kTagMosaic;
  if (kind == "aprilgrid") return TargetKind::kAprilGrid;
  if (kind == "charuco") return TargetKind::kCharuco;
  if (kind == "chessboard") return TargetKind::kChessboard;
  throw Error("there is no kind of target '" + kind +
                  "'; expected mosaic, aprilgrid, charuco or chessboard",
              ErrorKind::kUsage);
}

}  // namespace

int Run(const CalibrateTargetCommand& command, const Console& console) {
  TargetRequest request;
  request.kind = KindOf(command);
  request.family = command.family;
  request.paper = PaperSizeOf(command.size);
  request.pitch_mm = command.pitch_mm;
  request.columns = command.columns;
  request.rows = command.rows;
  const Target target = FitTarget(request);
  const std::string description = PrintTarget(command.output, target, request.paper);
  console.Note(
      fmt::format("{}: {}; its description: {}", command.output, Described(target), description));
  return kDone;
}

}  // namespace graticule::apps
