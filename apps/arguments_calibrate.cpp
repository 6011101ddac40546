#include <algorithm>

#include "arguments_parts.hpp"

namespace graticule::apps {
namespace {

void AddAccuracy(CLI::App* sub, double* accuracy_px, double* sigma_px) {
  sub->add_option("--accuracy", *accuracy_px,
                  "px, that the expected error shall not exceed anywhere in the image")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  sub->add_option("--sigma", *sigma_px,
                  "px, standard deviation of a corner on either axis; without it, as the residuals "
                  "say")
      ->check(CLI::PositiveNumber);
}

void AddImageTopic(CLI::App* sub, std::string* topic) {
  sub->add_option("--image-topic", *topic,
                  "of a ROS bag: sensor_msgs/Image or CompressedImage; by default the only one");
}

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
  AddImageTopic(sub, &command->image_topic);
  sub->add_option("--against", command->against,
                  "another camera file: how far the two are apart, after the best rotation");
  sub->add_option("--plot", command->picture, "draw the difference over the image: .svg or .png");
  sub->add_flag("--json", command->json, "one JSON object on stdout instead of the summary");
  sub->add_option("--plugin", command->reading.plugins, "a plug-in with the camera's lens")
      ->type_name("FILE")
      ->allow_extra_args(false);
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

void AddGuide(CLI::App* calibrate, Chosen* chosen) {
  auto command = std::make_shared<CalibrateGuideCommand>();
  CLI::App* sub = AddCommand(
      calibrate, "guide", "a page that says what to show the camera until it is calibrated",
      "  graticule calibrate guide --camera 0 --target target.yaml -o camera.yaml --mirror\n"
      "  graticule calibrate guide --simulate\n"
      "  graticule calibrate guide --headless --simulate --lens b -o camera.yaml --json",
      command, chosen);
  sub->add_option("--camera", command->camera, "the number of a camera that is plugged in")
      ->check(CLI::NonNegativeNumber);
  sub->add_option("--video", command->video,
                  "a film, or a ROS bag, instead; its steadiest frames are taken");
  sub->add_option("--folder", command->folder,
                  "pictures instead, each of them taken; new ones are waited for");
  sub->add_option("--simulate", command->simulate,
                  "a simulated person who follows the advice: images (rendered), or corners alone")
      ->expected(0, 1)
      ->default_str("images")
      ->check(CLI::IsMember({"images", "corners"}));
  sub->add_option("--lens", command->lens,
                  "of the simulation: a to f, as in the thesis' figure 5.8")
      ->capture_default_str();
  sub->add_option("--blur", command->blur_px, "px, of rendered images")
      ->check(CLI::Range(0., 20.))
      ->capture_default_str();
  sub->add_option("--noise", command->noise, "shades of 255, of rendered images")
      ->check(CLI::Range(0., 100.))
      ->capture_default_str();
  sub->add_option("--seed", command->seed, "of the simulation")->capture_default_str();
  sub->add_option("--width", command->width, "px, asked of the camera")->check(CLI::PositiveNumber);
  sub->add_option("--height", command->height, "px, asked of the camera")
      ->check(CLI::PositiveNumber);
  sub->add_option("--target", command->target,
                  "the target's description, YAML; without it, AprilCal's mosaic: 8 x 6 tags of "
                  "tag36h11, 38.1 mm from one to the next");
  AddImageTopic(sub, &command->image_topic);
  sub->add_option("--decimate", command->decimate,
                  "tags are looked for in a picture smaller by this factor; 1 finds small ones")
      ->check(CLI::Range(1., 8.))
      ->capture_default_str();
  sub->add_option("--take-every", command->take_every_s,
                  "s: take the steadiest frame of every so many, matched or not; 0: only what "
                  "matches (the default, but for films: 1)")
      ->check(CLI::NonNegativeNumber);
  sub->add_option("--model", command->model, "a camera model")->capture_default_str();
  sub->add_option("--board", command->board,
                  "the target's shape: flat, warped (bent), or free (every corner its own)")
      ->check(CLI::IsMember({"flat", "warped", "free"}))
      ->capture_default_str();
  AddAccuracy(sub, &command->accuracy_px, &command->sigma_px);
  sub->add_option("-o,--output", command->outputs,
                  "write the camera: FILE, or FORMAT:FILE as calibrate does; may be repeated")
      ->allow_extra_args(false);
  sub->add_option("--detections", command->detections,
                  "write the corners of the frames taken, for `graticule calibrate`: .json");
  sub->add_option("--listen", command->listen,
                  "an address of this machine, for a browser elsewhere; the page's address then "
                  "holds a secret")
      ->capture_default_str();
  sub->add_option("--port", command->port, "of the page; 0: any that is free")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  sub->add_flag("--mirror", command->is_mirrored, "show the live picture as a mirror");
  sub->add_flag("--headless", command->is_headless,
                "no page: run to the accuracy, or the source's end, as fast as it goes");
  sub->add_option("--frames", command->frames, "end after so many frames of the live picture");
  sub->add_flag("--json", command->json, "one JSON object on stdout instead of the summary");
  AddPlugins(sub, &command->reading);
}

}  // namespace

std::vector<std::string> GuideAsCommand(std::vector<std::string> words) {
  const auto calibrate = std::find(words.begin(), words.end(), "calibrate");
  const auto guide = std::find(calibrate, words.end(), "--guide");
  if (guide == words.end()) return words;
  words.erase(guide);
  words.insert(std::find(words.begin(), words.end(), "calibrate") + 1, "guide");
  return words;
}

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
  AddImageTopic(sub, &command->image_topic);
  sub->add_option("--detections", command->detections, "write the corners that were found: .json");
  sub->add_option("-o,--output", command->outputs,
                  "write the camera: FILE, or FORMAT:FILE with opencv, ros, kalibr, mrcal or "
                  "graticule; may be repeated")
      ->allow_extra_args(false);
  sub->add_option(
         "--model", command->model,
         "a camera model, built in or a plug-in's, or auto: the built-in one that predicts "
         "best what it has not seen")
      ->capture_default_str();
  sub->add_option("--board", command->board,
                  "the target's shape: flat, warped (bent), free (every corner its own), or auto")
      ->check(CLI::IsMember({"auto", "flat", "warped", "free"}))
      ->capture_default_str();
  AddAccuracy(sub, &command->accuracy_px, &command->sigma_px);
  sub->add_option("--range", command->range_m,
                  "m, at which the error is expected; without it, at infinity")
      ->check(CLI::PositiveNumber);
  sub->add_option("--report", command->report, "write a report: .html or .json");
  sub->add_option("--pictures", command->pictures, "a folder for its pictures: SVG and PNG");
  sub->add_option("--record", command->record, "write the factor graph, solved: .fg");
  sub->add_flag("--json", command->json, "one JSON object on stdout instead of the summary");
  AddPlugins(sub, &command->reading);
  AddEvaluate(sub, chosen);
  AddGuide(sub, chosen);
  AddTarget(sub, chosen);
}

}  // namespace graticule::apps
