#include "arguments_parts.hpp"

namespace graticule::apps {

void AddSegment(CLI::App* app, Chosen* chosen) {
  auto command = std::make_shared<SegmentCommand>();
  CLI::App* sub = AddCommand(
      app, "segment", "part a scan into its objects and surfaces",
      "  graticule segment scene.pcd -o labels.ply --picture labels.png\n"
      "  graticule segment sweep.csv --image hallway.png --rig rig.yaml --method joint -o out.ply\n"
      "  graticule segment 000000.bin --image 000000.png --rig calib.txt --json",
      command, chosen);
  sub->add_option("CLOUD", command->cloud,
                  "an organised cloud: .pcd, .ply, KITTI's .bin, or .csv of planar scans")
      ->required();
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
  sub->add_flag("--json", command->json, "one JSON object on stdout instead of the summary");
  sub->add_flag("--keep-unseen", command->keep_unseen,
                "keep points that the picture does not show, without a colour");
  sub->add_flag("--closed", command->is_closed,
                "the grid's last column is beside its first: a LIDAR that turns all around (.bin: "
                "always)");
  sub->add_option("--edge-cut", command->edge_cut_m, "m: longer links are cut (0.25; of .bin 2)")
      ->check(CLI::PositiveNumber);
  sub->add_option(
         "--grazing", command->grazing_deg,
         "degrees: links flatter than this to the view are cut (8; of .bin 2); 0: none are")
      ->check(CLI::Range(0.0, 89.0));
  sub->add_option("--normal-radius", command->normal_radius,
                  "rows and columns around a point that its normal is of")
      ->check(CLI::Range(1, 16));
  sub->add_option("--k-rgb", command->k_colour, "of Equation 4.3, for colours (0 to 255)")
      ->check(CLI::PositiveNumber);
  sub->add_option("--k-norm", command->k_normal, "of Equation 4.3, for normals (rad)")
      ->check(CLI::PositiveNumber);
  sub->add_option("--concave", command->concave_deg,
                  "degrees: a concave edge up to this angle does not part (convex: 19)")
      ->check(CLI::Range(0.0, 180.0));
  sub->add_option("--min-size", command->min_size, "points: smaller segments join a neighbour")
      ->check(CLI::NonNegativeNumber);
  sub->add_option("--every", command->stride, "take every so many rows and columns only")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
}

void AddSimulateScene(CLI::App* app, Chosen* chosen) {
  auto command = std::make_shared<SimulateSceneCommand>();
  CLI::App* sub = AddCommand(
      app, "simulate-scene", "make a scan and a picture of a scene whose labels are known",
      "  graticule simulate-scene hallway -o hallway\n"
      "  graticule segment hallway/scan.pcd --image hallway/image.png --rig hallway/rig.yaml "
      "--picture labels.png",
      command, chosen);
  sub->add_option("SCENE", command->scene,
                  "hallway (bins, a box, a ball) or hill (barrels, a tree)")
      ->required()
      ->check(CLI::IsMember({"hallway", "hill"}));
  sub->add_option("-o,--output", command->output, "the folder: scan.pcd, image.png, rig.yaml")
      ->required();
  sub->add_option("--seed", command->seed, "of the noise")->capture_default_str();
}

}  // namespace graticule::apps
