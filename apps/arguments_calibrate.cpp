#include "arguments_parts.hpp"

namespace graticule::apps {
namespace {

void AddEvaluate(CLI::App* calibrate, Chosen* chosen) {
  auto command = std::make_shared<CalibrateEvaluateCommand>();
  CLI::App* sub = AddCommand(
      calibrate, "evaluate", "test a calibrated camera on views that it was not made from",
      "  graticule calibrate evaluate camera.yaml test/*.json\n"
      "  graticule calibrate evaluate camera.yaml test.json --against opencv.yaml",
      command, chosen);
  sub->add_option("CAMERA", command->camera, "a camera file, any format that is read")->required();
  sub->add_option("TEST", command->sources, "recorded detections, or images")->required();
  sub->add_option("--target", command->target, "the target's description, for images: YAML");
  sub->add_option("--against", command->against,
                  "another camera file: how far the two are apart, after the best rotation");
  sub->add_option("--plot", command->picture, "draw the difference over the image: .svg or .png");
  sub->add_flag("--json", command->json, "one JSON object on stdout instead of the summary");
}

void AddTarget(CLI::App* calibrate, Chosen* chosen) {
  auto command = std::make_shared<CalibrateTargetCommand>();
  CLI::App* sub = AddCommand(
      calibrate, "target", "print a calibration target, at exact scale, and its description",
      "  graticule calibrate target --family tag36h11 --size A3 -o target.pdf\n"
      "  graticule calibrate target --kind charuco --size A4 --pitch 20 -o board.svg",
      command, chosen);
  sub->add_option("-o,--output", command->output, "the page: .pdf, .svg or .png")->required();
  sub->add_option("--kind", command->kind,
                  "mosaic (AprilTags in rows; the default), aprilgrid (Kalibr's), charuco, "
                  "chessboard");
  sub->add_option("--family", command->family,
                  "of the markers: tag36h11 (the default), DICT_4X4_50, ...");
  sub->add_option("--size", command->size, "of the page: A0 to A5, letter, legal, 420x297 (mm)")
      ->capture_default_str();
  sub->add_option("--pitch", command->pitch_mm,
                  "mm: a square's side, a grid tag's side, from one tag of a mosaic to the next")
      ->check(CLI::PositiveNumber);
  sub->add_option("--columns", command->columns, "instead of as many as fit")
      ->check(CLI::Range(1, 200));
  sub->add_option("--rows", command->rows, "instead of as many as fit")->check(CLI::Range(1, 200));
}

}  // namespace

void AddCalibrate(CLI::App* app, Chosen* chosen) {
  auto command = std::make_shared<CalibrateCommand>();
  CLI::App* sub =
      AddCommand(app, "calibrate", "find a camera's parameters, and how well they are known",
                 "  graticule calibrate images/ -o camera.yaml\n"
                 "  graticule calibrate left.json right.json -o kalibr:camchain.yaml\n"
                 "  graticule calibrate corners.json --model angular4 --record problem.fg --json",
                 command, chosen);
  sub->require_subcommand(0, 1);
  sub->add_option("SOURCES", command->sources,
                  "images, folders of them, patterns or a video; or recorded detections (.json, "
                  ".vnl, .orpc), of several cameras one file each");
  sub->add_option("--target", command->target,
                  "the target's description, for images: YAML, as `calibrate target` or Kalibr "
                  "writes it; without it, the target is guessed");
  sub->add_option("--detections", command->detections, "write the corners that were found: .json");
  sub->add_option("-o,--output", command->outputs,
                  "write the camera: FILE, or FORMAT:FILE with opencv, ros, kalibr, mrcal or "
                  "graticule; may be repeated")
      ->allow_extra_args(false);
  sub->add_option("--model", command->model,
                  "a camera model, or auto: the one that predicts best what it has not seen")
      ->capture_default_str();
  sub->add_option("--board", command->board,
                  "the target's shape: flat, warped (bent), free (every corner its own), or auto")
      ->check(CLI::IsMember({"auto", "flat", "warped", "free"}))
      ->capture_default_str();
  sub->add_option("--accuracy", command->accuracy_px,
                  "px, that the expected error shall not exceed anywhere in the image")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  sub->add_option("--sigma", command->sigma_px,
                  "px, standard deviation of a corner on either axis; without it, as the residuals "
                  "say")
      ->check(CLI::PositiveNumber);
  sub->add_option("--range", command->range_m,
                  "m, at which the error is expected; without it, at infinity")
      ->check(CLI::PositiveNumber);
  sub->add_option("--report", command->report, "write a report: .html or .json");
  sub->add_option("--pictures", command->pictures, "a folder for its pictures: SVG and PNG");
  sub->add_option("--record", command->record, "write the factor graph, solved: .fg");
  sub->add_flag("--json", command->json, "one JSON object on stdout instead of the summary");
  AddReading(sub, &command->reading);
  AddEvaluate(sub, chosen);
  AddTarget(sub, chosen);
}

}  // namespace graticule::apps
