#include "simulate/warehouse.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/units.hpp"

namespace rfmvo::simulate {
namespace {

using Eigen::Vector3d;

constexpr double kBay_m = 2.0, kRackDepth_m = 0.9, kUpright_m = 0.09, kRackHeight_m = 2.9, kBeam_m = 0.09;
constexpr std::array<double, 4> kShelves_m{0.12, 0.72, 1.32, 1.92};
constexpr double kCeiling_m = 5.0, kLampPitch_m = 4.0;
constexpr std::size_t kKinds = 14;  // of cartons: the same goods stand side by side, with the same labels
constexpr double kSameAgain = 0.6;  // chance that the next carton is of the same kind

struct Goods {
  std::vector<TexturePointer> fronts, sides;
  TexturePointer steel, beam, board;
};

Goods make_goods(Random& look) {
  Goods goods;
  for (std::size_t i = 0; i < kKinds; ++i) {
    goods.fronts.push_back(cardboard_texture(look));
    goods.sides.push_back(cardboard_texture(look));
  }
  goods.steel = steel_texture(look);
  goods.beam = steel_texture(look);
  goods.board = clutter_texture(look);
  return goods;
}

// Lamps hang every kLampPitch_m along x: what stands between two gets less light.
float light_at(double x_m) { return static_cast<float>(0.86 + 0.14 * std::cos(kTwoPi * x_m / kLampPitch_m)); }

void place(Environment& e, const Environment& part, const Rigid3& T_S_R) {
  for (const Surface& s : part.surfaces) {
    Surface there = moved(s, T_S_R);
    const Vector3d middle = there.corner + 0.5 * (there.width_m * there.right + there.height_m * there.down);
    there.brightness *= light_at(middle.x());
    e.surfaces.push_back(there);
  }
}

void add_frame(Environment& rack, double length_m, const Goods& goods) {
  for (double x = 0.0; x <= length_m + 0.01; x += kBay_m) {
    for (const double y : {0.0, kRackDepth_m - kUpright_m}) {
      add_box(rack, {x, y, 0.0}, {x + kUpright_m, y + kUpright_m, kRackHeight_m},
              {goods.steel, goods.steel, goods.steel, false});
    }
  }
  for (const double z : kShelves_m) {
    for (double x = 0.0; x < length_m - 0.01; x += kBay_m) {
      add_box(rack, {x, 0.02, z - kBeam_m}, {x + kBay_m, 0.07, z}, {goods.beam, goods.beam, goods.board, false});
      add_box(rack, {x, 0.07, z - 0.03}, {x + kBay_m, kRackDepth_m, z - 0.005},
              {goods.beam, goods.beam, goods.board, false});
    }
  }
}

// A row of racks along +x from the origin, fronts towards -y. Returns places on fronts of cartons.
std::vector<Vector3d> add_rack_row(Environment& e, const Rigid3& T_S_R, double length_m, const Goods& goods,
                                   Random& random) {
  Environment rack;
  std::vector<Vector3d> places;
  add_frame(rack, length_m, goods);
  std::size_t kind = 0;
  double width_m = 0.4, depth_m = 0.4, height_m = 0.3;
  for (const double shelf_m : kShelves_m) {
    for (double x = kUpright_m + random.uniform(0.03, 0.2); x < length_m - 0.6;) {
      if (random.uniform() > kSameAgain) {
        kind = random.below(kKinds);
        width_m = random.uniform(0.28, 0.6), depth_m = random.uniform(0.3, 0.5), height_m = random.uniform(0.22, 0.45);
      }
      const double in_bay_m = x - kBay_m * std::floor(x / kBay_m);
      if (in_bay_m < kUpright_m + 0.03) x += kUpright_m + 0.03 - in_bay_m;
      if (in_bay_m + width_m > kBay_m) x += kBay_m - in_bay_m + kUpright_m + 0.03;
      const double front = random.uniform(0.03, 0.28);
      add_box(rack, {x, front, shelf_m}, {x + width_m, front + depth_m, shelf_m + height_m},
              {goods.fronts[kind], goods.sides[kind], goods.sides[kind]});
      const Vector3d label(x + 0.5 * width_m, front, shelf_m + 0.7 * height_m);
      if (shelf_m > 0.4 && shelf_m < 1.4) places.push_back(T_S_R * label);
      x += width_m + random.uniform(0.02, 0.25);
    }
  }
  place(e, rack, T_S_R);
  return places;
}

// A wall that looks to its right-hand normal: `right` along the wall as the viewer sees it.
void add_wall(Environment& e, const Vector3d& corner, const Vector3d& right, double width_m, double height_m,
              const TexturePointer& texture, double texels_per_m) {
  e.surfaces.push_back(
      {corner, right, -Vector3d::UnitZ(), width_m, height_m, texture, {texels_per_m, texels_per_m}, 0.85F});
}

void add_floor_and_ceiling(Environment& e, const Vector3d& low, const Vector3d& high, double ceiling_m, Random& look) {
  const TexturePointer floor = concrete_texture(look), roof = steel_texture(look);
  const auto lamp = std::make_shared<const Texture>(2, std::vector<float>(16, 255.0F));
  const double width_m = high.x() - low.x(), depth_m = high.y() - low.y();
  e.surfaces.push_back(
      {{low.x(), high.y(), 0.0}, Vector3d::UnitX(), -Vector3d::UnitY(), width_m, depth_m, floor, {420, 420}, 0.9F});
  e.surfaces.push_back(
      {{low.x(), low.y(), ceiling_m}, Vector3d::UnitX(), Vector3d::UnitY(), width_m, depth_m, roof, {60, 60}, 0.6F});
  const double middle_y = 0.5 * (low.y() + high.y());
  for (double x = low.x() + 0.5 * kLampPitch_m; x < high.x(); x += kLampPitch_m) {
    e.surfaces.push_back(
        {{x, middle_y - 0.15, ceiling_m - 0.05}, Vector3d::UnitX(), Vector3d::UnitY(), 1.2, 0.3, lamp, {2, 2}, 1.0F});
  }
}

Rigid3 facing_back(const Vector3d& p) { return {Eigen::Quaterniond(Eigen::AngleAxisd(kPi, Vector3d::UnitZ())), p}; }

// Two boxes for the legs, one for the body, one for the head.
void add_body(Environment& body, Random& look) {
  const TexturePointer cloth = clutter_texture(look), skin = plaster_texture(look);
  add_box(body, {-0.2, -0.1, 0.0}, {-0.02, 0.1, 0.85}, {cloth, cloth, cloth, false});
  add_box(body, {0.02, -0.1, 0.0}, {0.2, 0.1, 0.85}, {cloth, cloth, cloth, false});
  add_box(body, {-0.23, -0.14, 0.85}, {0.23, 0.14, 1.45}, {cloth, cloth, cloth, false});
  add_box(body, {-0.1, -0.1, 1.47}, {0.1, 0.1, 1.75}, {skin, skin, skin, false});
}

std::function<Rigid3(double)> walk(const Crossing& c, double sway_m) {
  return [c, sway_m](double t_s) {
    const double s = t_s - c.from_s;
    const Vector3d p = c.from + Vector3d(c.speed_m_s * s, sway_m * std::sin(kTwoPi * 0.9 * s), 0.0);
    return Rigid3{Eigen::Quaterniond::Identity(), p};
  };
}

}  // namespace

std::vector<Vector3d> build_warehouse(Environment& e, std::uint64_t seed) {
  Random look(seed, "warehouse textures"), random(seed, "warehouse goods");
  const Goods goods = make_goods(look);
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY();
  const double length_m = kCrossAisleBegin_m - kRackBegin_m, behind_m = kLeftRack_m + 2.0 * kRackDepth_m;
  const auto places =
      add_rack_row(e, {Eigen::Quaterniond::Identity(), {kRackBegin_m, kLeftRack_m, 0}}, length_m, goods, random);
  add_rack_row(e, facing_back({kCrossAisleBegin_m, behind_m, 0}), length_m, goods, random);
  add_rack_row(e, {Eigen::Quaterniond::Identity(), {kRackBegin_m, behind_m + 3.0, 0}}, length_m, goods, random);
  add_rack_row(e, {Eigen::Quaterniond::Identity(), {kCrossAisleEnd_m, kLeftRack_m, 0}}, 8.0, goods, random);
  add_rack_row(e, facing_back({kCrossAisleEnd_m + 8.0, -kLeftRack_m - 0.6, 0}), 26.0, goods, random);
  const TexturePointer paint = plaster_texture(look);
  const Vector3d low(-8.0, -6.0, 0.0), high(25.0, 12.0, 0.0);
  add_wall(e, {low.x(), high.y(), kCeiling_m}, x, high.x() - low.x(), kCeiling_m, paint, 200);
  add_wall(e, {high.x(), low.y(), kCeiling_m}, -x, high.x() - low.x(), kCeiling_m, paint, 200);
  add_wall(e, {high.x(), high.y(), kCeiling_m}, -y, high.y() - low.y(), kCeiling_m, paint, 200);
  add_wall(e, {low.x(), low.y(), kCeiling_m}, y, high.y() - low.y(), kCeiling_m, paint, 200);
  add_floor_and_ceiling(e, low, high, kCeiling_m, look);
  return places;
}

std::vector<Vector3d> build_corridor(Environment& e, std::uint64_t seed) {
  Random look(seed, "corridor textures"), random(seed, "corridor walls");
  constexpr double kBegin_m = -3.0, kHeight_m = 2.6;
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY();
  const TexturePointer paint = plaster_texture(look), door = steel_texture(look);
  const double length_m = kCorridorEnd_m - kBegin_m, half_m = kCorridorHalfWidth_m;
  add_wall(e, {kBegin_m, half_m, kHeight_m}, x, length_m, kHeight_m, paint, 150);
  add_wall(e, {kCorridorEnd_m, -half_m, kHeight_m}, -x, length_m, kHeight_m, paint, 150);
  add_wall(e, {kCorridorEnd_m, half_m, kHeight_m}, -y, 2.0 * half_m, kHeight_m, paint, 150);
  add_wall(e, {kBegin_m, -half_m, kHeight_m}, y, 2.0 * half_m, kHeight_m, paint, 150);
  std::vector<Vector3d> places;
  for (double at = kBegin_m + 0.6; at < kCorridorEnd_m - 1.2; at += 1.2) {
    const double side = random.uniform() < 0.5 ? 1.0 : -1.0, width_m = random.uniform(0.2, 0.5);
    const double top_m = random.uniform(1.3, 2.0), off = 0.003;
    const TexturePointer notice = cardboard_texture(look);
    const double texels = 256.0 / width_m;
    const Vector3d corner = side > 0 ? Vector3d(at, half_m - off, top_m) : Vector3d(at + width_m, -half_m + off, top_m);
    e.surfaces.push_back({corner, side * x, -Vector3d::UnitZ(), width_m, width_m, notice, {texels, texels}, 1.0F});
    places.push_back({at, half_m - 0.01, random.uniform(0.6, 1.6)});
    if (random.uniform() < 0.35) {  // a door on the other side
      const Vector3d top = side > 0 ? Vector3d(at + 0.9, -half_m + off, 2.05) : Vector3d(at, half_m - off, 2.05);
      e.surfaces.push_back({top, -side * x, -Vector3d::UnitZ(), 0.9, 2.05, door, {120, 120}, 1.1F});
    }
  }
  add_floor_and_ceiling(e, {kBegin_m, -half_m, 0}, {kCorridorEnd_m, half_m, 0}, kHeight_m, look);
  return places;
}

Mover make_person(const Crossing& crossing, Random& look) {
  Environment body;
  add_body(body, look);
  return {body.surfaces, walk(crossing, 0.02)};
}

Mover make_forklift(const Crossing& crossing, Random& look) {
  Environment truck;
  const TexturePointer paint = steel_texture(look), mast = steel_texture(look), load = cardboard_texture(look);
  add_box(truck, {-0.35, -0.4, 0.1}, {0.35, 0.4, 1.1}, {paint, paint, paint, false});
  add_box(truck, {0.36, -0.3, 0.1}, {0.46, 0.3, 2.0}, {mast, mast, mast, false});
  add_box(truck, {0.48, -0.35, 0.3}, {0.9, 0.35, 0.9}, {load, load, load});
  add_box(truck, {-0.3, -0.3, 1.8}, {0.3, 0.3, 1.9}, {paint, paint, paint, false});
  return {truck.surfaces, walk(crossing, 0.0)};
}

}  // namespace rfmvo::simulate
