#include "graticule/problems/attenuation/simulate_plan.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/io/text.hpp"
#include "graticule/problems/random.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

struct Box {
  double x0, y0, x1, y1;  // m
};

/// Draws on a plan in metres.
class Draughtsman {
 public:
  Draughtsman(FloorPlan* plan, RandomNumbers* random) : plan_(plan), random_(random) {}

  void Fill(const Box& box, Filling filling) {
    const auto cell = [&](double m, std::size_t count) {
      return static_cast<std::size_t>(
          std::clamp(std::round(m / plan_->resolution), 0.0, static_cast<double>(count)));
    };
    const std::size_t x1 = cell(box.x1, plan_->width), y1 = cell(box.y1, plan_->height);
    for (std::size_t y = cell(box.y0, plan_->height); y < y1; ++y)
      for (std::size_t x = cell(box.x0, plan_->width); x < x1; ++x)
        plan_->cells[y * plan_->width + x] = filling;
  }

  /// The four walls of a box, inside of it.
  void Walls(const Box& box, Filling wall) {
    const double t = DrawnThickness(wall);
    Fill({box.x0, box.y0, box.x1, box.y0 + t}, wall);
    Fill({box.x0, box.y1 - t, box.x1, box.y1}, wall);
    Fill({box.x0, box.y0, box.x0 + t, box.y1}, wall);
    Fill({box.x1 - t, box.y0, box.x1, box.y1}, wall);
  }

  /// Where rooms along x from one end to the other begin, and the last ends.
  std::vector<double> Cuts(double from, double to, double least, double most) {
    std::vector<double> cuts = {from};
    while (to - cuts.back() > most + least)
      cuts.push_back(cuts.back() + random_->Uniform(least, most));
    if (to - cuts.back() > most) cuts.push_back((cuts.back() + to) / 2);
    cuts.push_back(to);
    return cuts;
  }

  /// Desks and cupboards that leave room to pass.
  void Furnish(const Box& room, double pieces_per_m2) {
    const double area = (room.x1 - room.x0) * (room.y1 - room.y0);
    for (int i = static_cast<int>(area * pieces_per_m2 + random_->Unit()); i > 0; --i) {
      const bool turned = random_->Unit() < 0.5;
      const double w = turned ? 0.7 : 1.4, h = turned ? 1.4 : 0.7;
      if (room.x1 - room.x0 < w + 2 || room.y1 - room.y0 < h + 2) continue;
      const double x = random_->Uniform(room.x0 + 1, room.x1 - 1 - w);
      const double y = random_->Uniform(room.y0 + 1, room.y1 - 1 - h);
      Fill({x, y, x + w, y + h}, Filling::kFurniture);
    }
  }

  RandomNumbers& Random() { return *random_; }

 private:
  FloorPlan* plan_;
  RandomNumbers* random_;
};

constexpr double kDoor_m = 1.1;

/// Rooms side by side in a band, each with a door to the corridor above or below it.
void RowOfRooms(const Box& band, bool door_above, Filling corridor_wall, Draughtsman* pen) {
  pen->Fill(band, Filling::kClutter);
  pen->Walls(band, corridor_wall);
  const std::vector<double> cuts = pen->Cuts(band.x0, band.x1, 3.2, 7);
  const double t = DrawnThickness(corridor_wall), half = DrawnThickness(Filling::kPartition) / 2;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    if (i > 0)
      pen->Fill({cuts[i] - half, band.y0 + t, cuts[i] + half, band.y1 - t}, Filling::kPartition);
    pen->Furnish({cuts[i], band.y0, cuts[i + 1], band.y1}, 0.05);
    const double x = pen->Random().Uniform(cuts[i] + 0.5, cuts[i + 1] - 0.5 - kDoor_m);
    if (door_above)
      pen->Fill({x, band.y1 - t, x + kDoor_m, band.y1}, Filling::kAir);
    else
      pen->Fill({x, band.y0, x + kDoor_m, band.y0 + t}, Filling::kAir);
  }
}

/// An outer wall of brick with windows of glass in it.
void OuterWall(const Box& box, Draughtsman* pen) {
  pen->Walls(box, Filling::kBrickWall);
  const double t = DrawnThickness(Filling::kBrickWall), glass = DrawnThickness(Filling::kGlassWall);
  for (double x = box.x0 + 2; x + 2 < box.x1 - 2; x += 4)
    for (const double y : {box.y0, box.y1 - t}) {
      pen->Fill({x, y, x + 2, y + t}, Filling::kAir);
      pen->Fill({x, y + glass, x + 2, y + 2 * glass}, Filling::kGlassWall);
    }
}

/// Rows of offices along corridors, which cross corridors join; in the middle stairs and lifts.
void Office(const Box& all, Draughtsman* pen) {
  pen->Fill(all, Filling::kAir);
  const double corridor = 2.2, wall = DrawnThickness(Filling::kBrickWall);
  const Box inside{all.x0 + wall, all.y0 + wall, all.x1 - wall, all.y1 - wall};
  const double height = inside.y1 - inside.y0, width = inside.x1 - inside.x0;
  // Each unit is a row of rooms, a corridor and another row.
  const int units = std::max(1, static_cast<int>(std::round(height / 13)));
  const double unit = height / units;
  const int columns = std::max(1, static_cast<int>(std::round(width / 30)));
  const double column = (width - (columns + 1) * corridor) / columns;
  for (int u = 0; u < units; ++u) {
    const double y0 = inside.y0 + u * unit, depth = (unit - corridor) / 2;
    for (int c = 0; c < columns; ++c) {
      const double x0 = inside.x0 + corridor + c * (column + corridor), x1 = x0 + column;
      const Filling built = pen->Random().Unit() < 0.5 ? Filling::kBlockWall : Filling::kPartition;
      RowOfRooms({x0, y0, x1, y0 + depth}, true, built, pen);
      RowOfRooms({x0, y0 + depth + corridor, x1, y0 + unit}, false, built, pen);
      if ((u + c) % 2 == 1 || units * columns == 1) continue;
      const double x = (x0 + x1) / 2, y = y0 + depth + corridor;
      const Box core{x - 3, y, x + 3, std::min(y + 5, y0 + unit)};
      pen->Fill(core, Filling::kAir);
      pen->Walls(core, Filling::kConcreteWall);
      pen->Fill({x, y + 1, x + 2, y + 3}, Filling::kLiftShaft);
    }
  }
  OuterWall(all, pen);
}

/// A hall with columns and rows of shelves, and a row of offices along it.
void Library(const Box& all, Draughtsman* pen) {
  pen->Fill(all, Filling::kClutter);
  RowOfRooms({all.x0, all.y0, all.x1, all.y0 + 6}, true, Filling::kBlockWall, pen);
  for (double x = all.x0 + 4; x < all.x1 - 9; x += 11) {
    const bool has_shelves = pen->Random().Unit() < 0.65;
    for (double y = all.y0 + 9; y < all.y1 - 2.5; y += 2.2) {
      if (has_shelves && pen->Random().Unit() < 0.9)
        pen->Fill({x, y, x + pen->Random().Uniform(6, 8.5), y + 0.5}, Filling::kBookshelf);
    }
    if (!has_shelves) pen->Furnish({x, all.y0 + 8, x + 9, all.y1 - 2}, 0.08);
  }
  for (double x = all.x0 + 2.5; x < all.x1 - 2; x += 11)
    for (double y = all.y0 + 8; y < all.y1 - 2; y += 8.8)
      pen->Fill({x, y, x + 0.6, y + 0.6}, Filling::kConcreteWall);
  const double x = (all.x0 + all.x1) / 2, y = (all.y0 + all.y1) / 2;
  const Box core{x - 4, y - 4, x + 4, y + 4};
  pen->Fill(core, Filling::kAir);
  pen->Walls(core, Filling::kConcreteWall);
  pen->Fill({x - 2, y - 1, x + 2, y + 1}, Filling::kLiftShaft);
  OuterWall(all, pen);
}

/// Rooms inside of brick walls.  Open: a front door and doors between them.
void House(const Box& box, bool is_open, Draughtsman* pen) {
  pen->Fill(box, Filling::kClutter);
  const double middle = (box.y0 + box.y1) / 2, t = DrawnThickness(Filling::kPartition);
  pen->Fill({box.x0, middle, box.x1, middle + t}, Filling::kPartition);
  for (const bool upper : {false, true}) {
    const double y0 = upper ? middle : box.y0, y1 = upper ? box.y1 : middle;
    const std::vector<double> cuts = pen->Cuts(box.x0, box.x1, 3, 5);
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
      if (i > 0) pen->Fill({cuts[i], y0 + t, cuts[i] + t, y1}, Filling::kPartition);
      if (!is_open) continue;
      pen->Furnish({cuts[i], y0, cuts[i + 1], y1}, 0.04);
      if (i > 0) pen->Fill({cuts[i], y0 + 1, cuts[i] + t, y0 + 1 + kDoor_m}, Filling::kClutter);
      if (upper && i % 2 == 0)
        pen->Fill({cuts[i] + 1, middle, cuts[i] + 1 + kDoor_m, middle + t}, Filling::kClutter);
    }
  }
  OuterWall(box, pen);
}

/// Apartment houses along streets, with parked cars, trees and hedges.
void Street(const Box& all, Draughtsman* pen) {
  pen->Fill(all, Filling::kAir);
  RandomNumbers& random = pen->Random();
  const double plot_x = 32, plot_y = 26;
  for (double y = all.y0 + 4; y + 14 < all.y1; y += plot_y)
    for (double x = all.x0 + 4; x + 16 < all.x1; x += plot_x) {
      const double w = std::min(random.Uniform(16, 25), all.x1 - x - 2);
      const double h = std::min(random.Uniform(10, 15), all.y1 - y - 2);
      if (random.Unit() < 0.85) {
        House({x, y, x + w, y + h}, false, pen);
        if (random.Unit() < 0.4) pen->Fill({x + 1, y - 2.2, x + w - 4, y - 1.4}, Filling::kHedge);
      } else {
        for (int i = 0; i < 6; ++i) {
          const double tx = random.Uniform(x, x + w), ty = random.Uniform(y, y + h);
          pen->Fill({tx, ty, tx + 0.5, ty + 0.5}, Filling::kTrunk);
        }
      }
      // A row of parked cars behind, and a tree or two.
      for (double cx = x; cx + 2 < x + w; cx += 2.8)
        if (random.Unit() < 0.4) pen->Fill({cx, y + h + 3, cx + 1.8, y + h + 7.2}, Filling::kCar);
      for (int i = 0; i < 2; ++i) {
        const double tx = random.Uniform(x + w + 1.5, x + plot_x - 2),
                     ty = random.Uniform(y, y + h);
        pen->Fill({tx, ty, tx + 0.5, ty + 0.5}, Filling::kTrunk);
      }
    }
}

}  // namespace

const std::vector<PlaceOptions>& KnownPlaces() {
  using Kind = PlaceOptions::Kind;
  static const std::vector<PlaceOptions> places = {
      {"nw1", Kind::kStreet, 160, 100, 900, 11}, {"nw2", Kind::kStreet, 150, 110, 900, 12},
      {"bbb3", Kind::kOffice, 90, 40, 600, 13},  {"eecs4", Kind::kOffice, 80, 52, 600, 14},
      {"dc1", Kind::kLibrary, 75, 50, 600, 15},  {"room", Kind::kRoom, 12, 9, 60, 16},
      {"house", Kind::kHouse, 16, 12, 120, 17},  {"office", Kind::kOffice, 40, 26, 240, 18},
      {"street", Kind::kStreet, 70, 50, 240, 19}};
  return places;
}

PlaceOptions PlaceByName(const std::string& name) {
  std::string list;
  for (const PlaceOptions& place : KnownPlaces()) {
    if (place.name == name) return place;
    list += (list.empty() ? "" : ", ") + place.name;
  }
  throw Error("there is no place " + Quoted(name) + "; there are: " + list, ErrorKind::kUsage);
}

OccupancyGrid FloorPlan::Occupied() const {
  OccupancyGrid grid;
  grid.resolution = resolution;
  grid.width = width;
  grid.height = height;
  grid.cells.reserve(cells.size());
  for (const Filling filling : cells)
    grid.cells.push_back(LossOf(filling).is_structure ? Occupancy::kStructure : Occupancy::kFree);
  return grid;
}

FloorPlan MakeFloorPlan(const PlaceOptions& options) {
  FloorPlan plan;
  const double cells = options.width_m * options.height_m / (plan.resolution * plan.resolution);
  if (!(options.width_m >= 4) || !(options.height_m >= 4) || !(cells < 0x1p28))
    throw Error("a place of " + Shown(options.width_m) + " x " + Shown(options.height_m) +
                    " m cannot be simulated; expected at least 4 m a side and below 2^28 cells",
                ErrorKind::kUsage);
  plan.width = static_cast<std::size_t>(std::round(options.width_m / plan.resolution));
  plan.height = static_cast<std::size_t>(std::round(options.height_m / plan.resolution));
  plan.cells.resize(plan.width * plan.height, Filling::kAir);
  RandomNumbers random(options.seed, 1);
  Draughtsman pen(&plan, &random);
  const Box all{0, 0, options.width_m, options.height_m};
  switch (options.kind) {
    case PlaceOptions::Kind::kRoom:
      pen.Fill(all, Filling::kClutter);
      pen.Furnish(all, 0.04);
      OuterWall(all, &pen);
      break;
    case PlaceOptions::Kind::kHouse:
      House(all, true, &pen);
      break;
    case PlaceOptions::Kind::kOffice:
      Office(all, &pen);
      break;
    case PlaceOptions::Kind::kLibrary:
      Library(all, &pen);
      break;
    case PlaceOptions::Kind::kStreet:
      Street(all, &pen);
      plan.exponent = FloorPlan::kStreetExponent;
      break;
  }
  return plan;
}

}  // namespace graticule
