#include "arguments_parts.hpp"

namespace graticule::apps {

void AddCoregister(CLI::App* app, Chosen* chosen) {
  auto command = std::make_shared<CoregisterCommand>();
  CLI::App* sub = AddCommand(
      app, "coregister", "find where a camera is on its LIDAR, and how well that is known",
      "  graticule coregister --camera camera.yaml --points correspondences.csv -o rig.yaml\n"
      "  graticule coregister --camera ros.yaml --points c.csv --free --plot residuals.png --json",
      command, chosen);
  sub->add_option("--camera", command->camera, "a camera file, any format that is read")
      ->required();
  sub->add_option("--points", command->points,
                  "points that both have seen: lines x,y,z,u,v[,name] (m, px)");
  sub->add_option("--detections", command->detections,
                  "recorded detections of boards, beside --planes: .json");
  sub->add_option("--planes", command->planes,
                  "the boards' planes as the LIDAR measured them: lines image,nx,ny,nz,offset");
  sub->add_option("-o,--output", command->output, "write the rig: .yaml");
  sub->add_option("--against", command->against,
                  "another rig, or the true one: how far the two are apart");
  sub->add_flag("--free", command->free_parameters,
                "free the camera's parameters, too, one by one, where the error of points left "
                "out falls");
  sub->add_option(
         "--outlier-share", command->outlier_share,
         "of the correspondences that are called wrong, this share may be right; 0.1 finds "
         "more that are a little wrong")
      ->check(CLI::Range(1e-9, 0.2))
      ->capture_default_str();
  sub->add_option("--sigma", command->sigma_px,
                  "px, standard deviation of a pixel on either axis; without it, as the residuals "
                  "say")
      ->check(CLI::PositiveNumber);
  sub->add_option("--lidar-sigma", command->sigma_m,
                  "m, standard deviation of a LIDAR's point on any axis; 0: pixels alone count")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  sub->add_option("--range", command->ranges_m,
                  "m, at which errors are expected; may be repeated; without it, the nearest, the "
                  "median and the farthest of the points")
      ->check(CLI::PositiveNumber)
      ->allow_extra_args(false);
  sub->add_option("--plot", command->picture,
                  "draw the points' residuals over the image: .svg or .png");
  sub->add_option("--error-map", command->error_map,
                  "draw the expected error over the image, at the first range: .svg or .png");
  sub->add_option("--record", command->record, "write the factor graph, solved: .fg");
  sub->add_flag("--json", command->json, "one JSON object on stdout instead of the summary");
  AddPlugins(sub, &command->reading);
}

}  // namespace graticule::apps
