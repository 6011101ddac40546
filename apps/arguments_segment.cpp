#include "arguments_parts.hpp"

#include <cmath>

namespace graticule::apps {
namespace {

CLI::Validator WholeNumber(int least, int most) {
  return CLI::Validator(
      [=](const std::string& word) -> std::string {
        double number = 0;
        if (CLI::detail::lexical_cast(word, number) && number == std::floor(number) &&
            number >= least && number <= most)
          return {};
        return "expected a whole number from " + std::to_string(least) + " to " +
               std::to_string(most) + ", found '" + word + "'";
      },
      "INT");
}

void AddChoosing(CLI::App* sub, SegmentChoosing* choosing) {
  sub->add_flag(
      "--closed", choosing->is_closed,
      "the grid's last column is beside its first: a LIDAR that turns all around (KITTI's "
      ".bin: always)");
  sub->add_option("--edge-cut", choosing->edge_cut_m, "m: longer links are cut (0.25; of .bin 2)")
      ->check(CLI::PositiveNumber);
  sub->add_option(
         "--grazing", choosing->grazing_deg,
         "degrees: links flatter than this to the view are cut (8; of .bin 2); 0: none are")
      ->check(CLI::Range(0.0, 89.0));
  sub->add_option("--normal-radius", choosing->normal_radius,
                  "rows and columns around a point that its normal is of")
      ->check(WholeNumber(1, 16));
  sub->add_option("--k-rgb", choosing->k_colour, "of Equation 4.3, for colours (0 to 255)")
      ->check(CLI::PositiveNumber);
  sub->add_option("--k-norm", choosing->k_normal, "of Equation 4.3, for normals (rad)")
      ->check(CLI::PositiveNumber);
  sub->add_option("--concave", choosing->concave_deg,
                  "degrees: a concave edge up to this angle does not part (convex: 19)")
      ->check(CLI::Range(0.0, 180.0));
  sub->add_option("--min-size", choosing->min_size, "points: smaller segments join a neighbour")
      ->check(WholeNumber(0, 1000000000));
}

void AddEvaluate(CLI::App* segment, Chosen* chosen) {
  auto command = std::make_shared<SegmentEvaluateCommand>();
  CLI::App* sub = AddCommand(
      segment, "evaluate", "hold segmentations against scans whose labels are known",
      "  graticule segment evaluate test/*.pcd --least-object 20\n"
      "  graticule segment evaluate learn/*.pcd --methods joint colour --sweep "
      "k-rgb=300,1000,3000,10000 --plot sweep.svg\n"
      "  graticule segment evaluate learn/*.pcd --sweep k-rgb=1000,10000 --sweep k-norm=5,10,20 "
      "--report sweep.html --json",
      command, chosen);
  sub->add_option("SCANS", command->scans, "organised clouds, as segment reads them")->required();
  sub->add_option("--truth", command->truth,
                  "clouds of the same grids with labels, one a scan; without it, the scans' own "
                  "labels; 0 does not count");
  sub->add_option("--methods", command->methods, "as segment's --method")->capture_default_str();
  sub->add_option(
         "--sweep", command->sweeps,
         "try these values of k-rgb, k-norm, min-size, normal-radius, concave, edge-cut or "
         "grazing; may be repeated: every combination")
      ->type_name("NAME=VALUE,VALUE,...")
      ->allow_extra_args(false);
  sub->add_option("--least-object", command->least_object,
                  "labels below it are background: no objects of F and of what is found")
      ->check(CLI::Range(1, 1000000000))
      ->capture_default_str();
  sub->add_option("--plot", command->plot, "draw all scores over each parameter: .svg or .png");
  sub->add_option("--report", command->report, "a page with these plots and all rows: .html");
  sub->add_flag("--json", command->json, "one JSON object on stdout instead of the table");
  AddChoosing(sub, &command->choosing);
}

}  // namespace

void AddSegment(CLI::App* app, Chosen* chosen) {
  auto command = std::make_shared<SegmentCommand>();
  CLI::App* sub = AddCommand(
      app, "segment", "part a scan into its objects and surfaces",
      "  graticule segment scene.pcd -o labels.ply --picture labels.png\n"
      "  graticule segment sweep.csv --image hallway.png --rig rig.yaml --method joint -o out.ply\n"
      "  graticule segment 000000.bin --image 000000.png --rig calib.txt --json",
      command, chosen);
  sub->require_subcommand(0, 1);
  sub->add_option("CLOUD", command->cloud,
                  "an organised cloud: .pcd, .ply, KITTI's .bin, or .csv of planar scans");
  sub->add_option("--image", command->image, "a picture that the points take their colours from");
  sub->add_option("--rig", command->rig,
                  "its camera and how the LIDAR is to it: as `graticule coregister` writes it, or "
                  "KITTI's calib .txt");
  sub->add_option("-m,--method", command->method,
                  "convex (objects: what is convex), joint (colour and normals, the thesis' "
                  "algorithm), colour, normals, image (the grid's colours alone)")
      ->check(CLI::IsMember({"convex", "joint", "colour", "normals", "image"}))
      ->capture_default_str();
  sub->add_option("-o,--output", command->output, "write the cloud with its labels: .ply or .pcd");
  sub->add_option("--colours", command->colours,
                  "of the output's points: false (a colour a segment), mean (of the segment), own")
      ->check(CLI::IsMember({"false", "mean", "own"}))
      ->capture_default_str();
  sub->add_option("--picture", command->picture,
                  "draw the scan's grid as it is, in false and in mean colours: .png");
  sub->add_option("--label-image", command->label_image,
                  "the labels of the scan's grid as shades of 16 bits: .png");
  sub->add_option("--report", command->report,
                  "a page with pictures, segments and what was asked for: .html");
  sub->add_option("--score-from", command->score_from,
                  "say how well the segments find the cloud's own labels: things are those from "
                  "this one on (20 of simulated scenes), smaller ones background")
      ->type_name("LABEL")
      ->check(CLI::PositiveNumber);
  sub->add_flag("--json", command->json, "one JSON object on stdout instead of the summary");
  sub->add_flag("--keep-unseen", command->keep_unseen,
                "keep points that the picture does not show, without a colour");
  AddChoosing(sub, &command->choosing);
  sub->add_option("--every", command->stride, "take every so many rows and columns only")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  AddEvaluate(sub, chosen);
}

}  // namespace graticule::apps
