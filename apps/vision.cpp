#include "commands.hpp"
#include "launcher.hpp"

// OpenCV's readers of pictures and films bring two hundred shared libraries, which take five times
// as long to load as the rest of the program: only the commands that look at pictures pay for them,
// in a program of their own beside this one.

namespace graticule::apps {
namespace {

int BecomeVision() {
  return Become("graticule-vision", "the part of graticule that looks at pictures cannot be run");
}

}  // namespace

int Run(const CalibrateCommand&, const Console&) { return BecomeVision(); }
int Run(const CalibrateEvaluateCommand&, const Console&) { return BecomeVision(); }
int Run(const CalibrateGuideCommand&, const Console&) { return BecomeVision(); }
int Run(const CalibrateTargetCommand&, const Console&) { return BecomeVision(); }
int Run(const SegmentCommand&, const Console&) { return BecomeVision(); }
int Run(const SegmentEvaluateCommand&, const Console&) { return BecomeVision(); }
int Run(const SimulateMissionCommand&, const Console&) { return BecomeVision(); }
int Run(const SimulateSceneCommand&, const Console&) { return BecomeVision(); }
int Run(const CoregisterCommand&, const Console&) { return BecomeVision(); }

}  // namespace graticule::apps
