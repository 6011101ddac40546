// Scores and CPU time on the labelled table scenes, beside PCL's segmentations where they are
// installed: the table of docs/segmentation.md.
//
//   graticule_segmentation_peers [learn|test]

#include <fmt/core.h>

#include <ctime>
#include <filesystem>
#include <functional>
#include <set>
#include <string>

#include "graticule/io/cloud_files.hpp"
#include "graticule/problems/segmentation/segment_score.hpp"
#include "graticule/problems/segmentation/segmenter.hpp"

#ifdef GRATICULE_HAS_PCL
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/lccp_segmentation.h>
#include <pcl/segmentation/region_growing_rgb.h>
#include <pcl/segmentation/supervoxel_clustering.h>
#endif

namespace graticule {
namespace {

using Labels = std::vector<std::uint32_t>;
using Method = std::function<Labels(const PointCloud&)>;

void Report(const std::string& name, const std::vector<PointCloud>& scenes, const Method& method) {
  ScoreOptions options;
  options.least_object = 20;
  std::vector<SegmentScore> scores;
  double seconds = 0;
  const double share = 1 / static_cast<double>(scenes.size());
  for (const PointCloud& scene : scenes) {
    method(scene);  // memory is there
    const std::clock_t start = std::clock();
    const Labels labels = method(scene);
    seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    options.width = scene.width;
    scores.push_back(ScoreOf(scene.labels, labels, options));
  }
  const SegmentScore mean = MeanOf(scores);
  fmt::print("{:<18} {:8.1f} {:7.3f} {:7.3f} {:7.3f} {:7.3f} {:7.3f} {:7.3f} {:9.1f}\n", name,
             1e3 * seconds * share, mean.weighted_overlap, mean.achievable, mean.under_segmentation,
             mean.boundary_recall, mean.mean_f, mean.found,
             static_cast<double>(mean.segments) * share);
}

#ifdef GRATICULE_HAS_PCL
template <class Point>
typename pcl::PointCloud<Point>::Ptr PclCloud(const PointCloud& cloud, bool keep_missing,
                                              std::vector<std::size_t>* places) {
  typename pcl::PointCloud<Point>::Ptr out(new pcl::PointCloud<Point>);
  for (std::size_t i = 0; i < cloud.Size(); ++i) {
    if (!keep_missing && !cloud.in_sensor[i].allFinite()) continue;
    Point point;
    point.getVector3fMap() = cloud.in_sensor[i];
    point.r = cloud.colours[i][0];
    point.g = cloud.colours[i][1];
    point.b = cloud.colours[i][2];
    out->push_back(point);
    places->push_back(i);
  }
  if (keep_missing) {
    out->width = static_cast<std::uint32_t>(cloud.width);
    out->height = static_cast<std::uint32_t>(cloud.height);
    out->is_dense = false;
  }
  return out;
}

// As PCL's example has it, with segments of at least `least` supervoxels.
Labels Lccp(const PointCloud& cloud, std::uint32_t least) {
  using Point = pcl::PointXYZRGBA;
  std::vector<std::size_t> places;
  const auto in = PclCloud<Point>(cloud, true, &places);
  pcl::SupervoxelClustering<Point> voxels(0.0075f, 0.03f);
  voxels.setInputCloud(in);
  voxels.setColorImportance(0);
  voxels.setSpatialImportance(1);
  voxels.setNormalImportance(4);
  std::map<std::uint32_t, pcl::Supervoxel<Point>::Ptr> clusters;
  voxels.extract(clusters);
  std::multimap<std::uint32_t, std::uint32_t> neighbours;
  voxels.getSupervoxelAdjacency(neighbours);
  pcl::LCCPSegmentation<Point> lccp;
  lccp.setConcavityToleranceThreshold(10);
  lccp.setSanityCheck(true);
  lccp.setSmoothnessCheck(false, 0.0075f, 0.03f, 0.1f);
  lccp.setKFactor(0);
  lccp.setInputSupervoxels(clusters, neighbours);
  lccp.setMinSegmentSize(least);
  lccp.segment();
  const auto labelled = voxels.getLabeledCloud();
  lccp.relabelCloud(*labelled);
  Labels labels;
  for (const auto& point : *labelled) labels.push_back(point.label);
  return labels;
}

Labels RegionGrowing(const PointCloud& cloud) {
  using Point = pcl::PointXYZRGB;
  std::vector<std::size_t> places;
  pcl::search::KdTree<Point>::Ptr tree(new pcl::search::KdTree<Point>);
  pcl::RegionGrowingRGB<Point> growing;
  growing.setInputCloud(PclCloud<Point>(cloud, false, &places));
  growing.setSearchMethod(tree);
  growing.setDistanceThreshold(10);
  growing.setPointColorThreshold(6);
  growing.setRegionColorThreshold(5);
  growing.setMinClusterSize(600);
  std::vector<pcl::PointIndices> clusters;
  growing.extract(clusters);
  Labels labels(cloud.Size(), 0);
  for (std::size_t k = 0; k < clusters.size(); ++k)
    for (const int i : clusters[k].indices)
      labels[places[static_cast<std::size_t>(i)]] = static_cast<std::uint32_t>(k + 1);
  return labels;
}
#endif

int Main(const std::string& set) {
  const std::string folder = GRATICULE_DATA_DIR "/segment/mosd/" + set;
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.insert(entry.path());
  std::vector<PointCloud> scenes;
  for (const auto& file : files) scenes.push_back(ReadCloud(file.string()));
  fmt::print("{:<18} {:>8} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>9}\n", set, "CPU ms", "WOv",
             "ASA", "UE", "BR", "F", "found", "segments");
  for (const char* name : {"convex", "joint", "normals", "colour", "image"}) {
    Segmenter segmenter(DefaultsOf(SegmentMethodOf(name)));
    Report(name, scenes, [&](const PointCloud& cloud) { return segmenter.Segment(cloud); });
  }
#ifdef GRATICULE_HAS_PCL
  Report("PCL LCCP", scenes, [](const PointCloud& cloud) { return Lccp(cloud, 0); });
  Report("PCL LCCP, min 3", scenes, [](const PointCloud& cloud) { return Lccp(cloud, 3); });
  Report("PCL RegionGrowRGB", scenes, RegionGrowing);
#else
  fmt::print("PCL was not found when this was built\n");
#endif
  return 0;
}

}  // namespace
}  // namespace graticule

int main(int argc, char** argv) { return graticule::Main(argc > 1 ? argv[1] : "test"); }
